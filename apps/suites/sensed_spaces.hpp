#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/suites/suite_scans.hpp"
#include "datasets/descriptions/suite.hpp"
#include "mapping/continued_map.hpp"
#include "planning/team/team.hpp"

namespace clearway {

/// What sensors saw where nothing was before, as robots know it from some time on.
struct SeenAnew {
  double time = 0.0;  ///< s
  std::vector<Eigen::Vector3d>
      voxels;  ///< middles of those that block and did not in the map before, in order
};

/// What a team's robots know of the map while sensors look, time after time, at a world and at what moves in
/// it: scans change a copy of the map that the world is known by, paint and all, distance fields are brought
/// up to date where something changed, and robots get the map when the latency is over. Between two scans
/// they go on with the last one. What stands still is what is occupied in the world's map (conflicts among
/// it), and the world's solids. Rays are without noise and never cross what stands still, so that scans free
/// all that they pass (`compatible` integration), up to what lies against a wall.
class SensedSpaces {
 public:
  /// Sees the world, and where sensed things are at time 0, at once. Keeps references to team, moving,
  /// sensing and policies.
  /// @param moving of the team; those that are not sensed do not count
  /// @param map of the world, as robots know it before anything is seen; of a world without name it does not
  ///        count, voxels are of sensing.resolution then
  /// @throws std::invalid_argument as check_sensors
  SensedSpaces(const Team& team, const std::vector<SuiteMoving>& moving, const SuiteSensing& sensing,
               const SuiteWorld& world, const Snapshot& map,
               const std::map<std::string, std::string>& policies);

  /// The space of robot number `robot` at `time`; times must not go back.
  std::shared_ptr<const ConfigurationSpace> at(std::size_t robot, double time);

  const Snapshot& map() const { return latest_; }
  /// Before anything was seen.
  const Snapshot& map_before() const { return before_; }
  /// What was seen anew, change by change; the first is at time 0.
  const std::vector<SeenAnew>& seen_anew() const { return seen_anew_; }
  /// For each time at which the first robot asked, how long ago the last scan of its map was, s.
  const std::vector<double>& ages() const { return ages_; }

 private:
  /// A sensor, and what it sees of what stands still.
  struct Sensor {
    Eigen::Vector3d place;
    Scan still{};
  };
  struct Seen {
    double taken, time;  ///< s: of its scans, when robots have it
    std::vector<std::shared_ptr<const ConfigurationSpace>> spaces;
  };
  void add_sensor(const Eigen::Vector3d& place, const SuiteWorld& world);
  std::vector<SceneShape> moving_at(double time) const;
  void look(double time);
  void see_until(double time);
  void note_what_is_new(double time, std::vector<Eigen::Vector3d> places);

  const Team& team_;
  const std::vector<SuiteMoving>& moving_;
  const SuiteSensing& sensing_;
  const std::map<std::string, std::string>& policies_;
  ContinuedMap fused_;
  Snapshot before_, latest_;
  std::shared_ptr<const BlockedSpace> occupied_;  ///< of the map before
  std::vector<Sensor> sensors_;
  std::vector<Eigen::Vector3d> uncharted_;  ///< voxels of solids that the map before does not have
  std::vector<SeenAnew> seen_anew_;
  std::vector<double> ages_;
  std::size_t scans_ = 0;
  std::deque<Seen> seen_;  ///< the first is what robots have
};

/// @throws std::invalid_argument when a sensor stands where nothing can be seen, in an occupied voxel of
///         `map`; the sentence says which
void check_sensors(const SuiteSensing& sensing, const Snapshot& map);

/// @throws std::invalid_argument when something that is sensed comes to where a sensor stands; the sentence
///         says which, and when
void check_sensors(const SuiteSensing& sensing, const Team& team);

}  // namespace clearway
