#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/files/map_file.hpp"
#include "mapping/voxels/voxel_state.hpp"
#include "planning/problem/pick.hpp"
#include "planning/robot/goal_configurations.hpp"

namespace clearway {

/// A query as it was asked, before any planner answered: what a plan for it is held to.
struct QueryTerms {
  std::string name;
  std::string robot;   ///< name or path, as given
  double scale = 1.0;  ///< against the full-size robot
  Eigen::Isometry3d map_from_base = Eigen::Isometry3d::Identity();
  std::map<std::string, Policy> policies;       ///< of every part
  double padding = 0.0;                         ///< metres
  double seen_within = 0.0;                     ///< of parts under known_free, seconds; 0: ever
  std::vector<std::string> allow_outside = {};  ///< parts that may leave the map's bounds, or "all"
  Configuration start;
  std::vector<Configuration> goals;
  std::vector<GoalPose> goal_poses = {};        ///< what was asked, where `goals` are one choice of them
  std::string tip = {};                         ///< link that the poses place; empty: the robot's own tip
  std::vector<LegLoad> loads = {};              ///< that ride on the robot
  std::optional<Pick> pick = {};                ///< what is picked and placed
  std::optional<double> payload = {};           ///< kg at the tip, full size; none: the record is older
  std::optional<Eigen::Vector3d> gravity = {};  ///< m/s^2, map frame; the same
  std::vector<std::string> joints = {};         ///< of start and goals, in this order; none: the same
};

/// The record that a map folder keeps of its queries, in DIR/queries.json. It holds for one map.
struct QueryRecord {
  std::string map_sha256;
  std::vector<QueryTerms> queries;
  std::string made_for = {};  ///< the digest of the map that `inspect` made this one of; empty: none

  /// The query of that name, else the one with that start and these goals (each value within `tolerance`, rad
  /// or m); null when there is none.
  const QueryTerms* find(const std::string& name, const Configuration& start,
                         const std::vector<Configuration>& goals, double tolerance) const;

  /// The first query of which start and goals are a part: it starts there or has a goal there, and has these
  /// goals, in this order, among its own; null when there is none.
  const QueryTerms* find_whole(const Configuration& start, const std::vector<Configuration>& goals,
                               double tolerance) const;
};

/// {"pose", "position_tolerance_m", "turn_tolerance_rad"} and, where it has one, "free_axis".
nlohmann::ordered_json json_of(const GoalPose& goal);

/// Largest difference of any value; infinite when the sizes differ or a value is not finite.
double largest_difference(const Configuration& a, const Configuration& b);

/// The text of queries.json: the queries, the digest of their map and a checksum over both.
std::string to_json(const QueryRecord& record);

/// A map, the digest of the bytes that it was read from, and the record in its folder: all of one moment.
struct RecordedMap {
  Snapshot map;
  std::string sha256;
  std::optional<QueryRecord> record;
};

/// What load_map_with has to read for the record.
FileBeside record_beside();
/// The record of a map that was loaded with record_beside() from `map`. @throws as load_query_record
std::optional<QueryRecord> record_of(const LoadedMap& loaded, const std::filesystem::path& map);

/// The same for a map that is made of the loaded one, of which it says so; none: there is none, or it is of
/// another map. @throws as load_query_record
std::optional<QueryRecord> record_to_hand_on(const LoadedMap& loaded, const std::filesystem::path& map);

/// One sentence where `map` is, or has as its map.ot, a link into a folder with a record of queries, which
/// does not count for it; else empty.
std::string record_aside(const std::filesystem::path& map);

/// As load_map_with, and what load_query_record says of the record.
RecordedMap load_recorded_map(const std::filesystem::path& map, std::optional<double> cloud_resolution = {});

/// The record of a map folder, or of the folder whose map.ot `map` is; nothing when it holds none.
/// @throws DamagedFile when the checksum does not match, std::invalid_argument naming the field that is
/// wrong.
std::optional<QueryRecord> load_query_record(const std::filesystem::path& map);

}  // namespace clearway
