#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/console/commands.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/files/map_leaves.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/maps/hand_edit.hpp"
#include "mapping/snapshot.hpp"
#include "planning/files/query_record.hpp"

namespace clearway {

// What `inspect` says, one file a question: `describe_…` finds it out as JSON, `print_…` says it as text.
// Lengths are metres in the map frame.

/// The map as a whole: where it is from, voxels by state, bounds, painted volumes. @param sha256 of its file
nlohmann::ordered_json describe_map(const InspectOptions& options, const MapLeaves& leaves,
                                    const std::string& sha256);
void print_map(const nlohmann::ordered_json& json, std::ostream& out);

/// What people call the map: the name of its folder, or of its file.
std::string name_of_map(const std::filesystem::path& map);

/// The state of one voxel, why, and how far the nearest blocked voxels are. With `provenance` (may be null)
/// also which strokes and which scans made it so.
nlohmann::ordered_json describe_point(const Snapshot& map, const Provenance* provenance,
                                      const Eigen::Vector3d& point);
void print_point(const nlohmann::ordered_json& json, std::ostream& out);

/// Quality of each painted volume: exact volume and area, what the voxels lose, sample spacing, holes, necks.
nlohmann::ordered_json describe_volumes(const Snapshot& map);
void print_volumes(const nlohmann::ordered_json& json, std::ostream& out);

/// Which strokes and scans made the voxel of a point what it is.
nlohmann::ordered_json describe_provenance(const Provenance& provenance, const Snapshot& map,
                                           const Eigen::Vector3d& point);
/// As rows "painted by stroke", "erased by stroke", "hit by scans", "passed by scans".
std::vector<std::pair<std::string, std::string>> provenance_rows(const nlohmann::ordered_json& json);

/// Where painted space turned out occupied.
nlohmann::ordered_json describe_conflicts(const Provenance& provenance);
void print_conflicts(const nlohmann::ordered_json& json, std::ostream& out);

/// States along the ray "ox,oy,oz,dx,dy,dz". @throws std::invalid_argument for another text.
nlohmann::ordered_json describe_ray(const Snapshot& map, const std::string& ray);
void print_ray(const nlohmann::ordered_json& json, std::ostream& out);

/// How a map differs from another, that in the file `other`.
nlohmann::ordered_json describe_difference(const Snapshot& map, const Snapshot& there,
                                           const std::filesystem::path& other);
void print_difference(const nlohmann::ordered_json& json, std::ostream& out);

/// Whether --merge, --clear, --occupy, --crop or --coarsen make another map.
bool is_edited(const InspectOptions& options);

/// What making another map leaves to tell.
struct EditReport {
  HandEditTally tally;  ///< of --clear and --occupy
  std::string clock_remark =
      {};                 ///< why times of MAP and --merge are not compared, and dropped; may be empty
  LoadedMap merged = {};  ///< that of --merge without its voxels
};

/// The map after these, in this order; as it is without them. @param[out] report of what was done
/// @throws std::invalid_argument.
Snapshot edited(const InspectOptions& options, const Snapshot& map, EditReport& report);

/// What to tell when --occupy and --clear changed nothing; empty otherwise.
std::string hand_edit_remark(const InspectOptions& options, const HandEditTally& tally);
/// How many voxels --clear and --occupy changed, by the state that they have now.
nlohmann::ordered_json describe_hand_edit(const HandEditTally& tally);
void print_hand_edit(const nlohmann::ordered_json& json, std::ostream& out);

/// A record of queries, and what to tell of another one; none: empty.
struct KeptRecord {
  std::optional<QueryRecord> record = {};
  std::string remark = {};
};

/// The queries that MAP has a record of, else those of the map of --merge, for the map that --save makes of
/// them; none of them without --save.
/// @param map, merged as they were read with record_beside()
/// @throws as load_query_record, of the record that would be kept
KeptRecord record_to_keep(const InspectOptions& options, const LoadedMap& map, const LoadedMap& merged);

/// Writes the map to --save, with these queries. @throws std::invalid_argument when that would replace a map
/// that was read.
void save_edited(const InspectOptions& options, std::optional<QueryRecord> record, const Snapshot& map);

/// A point or direction as [x, y, z].
nlohmann::ordered_json to_json(const Eigen::Vector3d& v);

/// "x, y, z" of a point written by to_json.
std::string point_text(const nlohmann::ordered_json& point);

/// Names as "a, b", or "-".
std::string join(const nlohmann::ordered_json& names);

/// A length as "12.34 mm".
std::string length_text(const nlohmann::ordered_json& metres);

}  // namespace clearway
