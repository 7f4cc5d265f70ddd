#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "datasets/suite.hpp"
#include "mapping/continued_map.hpp"
#include "planning/team.hpp"

namespace clearway {

/// What a team's robots know of the map while sensors look, time after time, at a world and at what moves in
/// it: scans change a copy of the map that the world is known by, paint and all, distance fields are brought
/// up to date where something changed, and robots get the map when the latency is over. Between two scans
/// they go on with the last one. What stands still is the world's solids; of a loaded world, the voxels that
/// are occupied in its map (conflicts among them).
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

 private:
  /// A sensor, and what it sees of a loaded world.
  struct Sensor {
    Eigen::Vector3d place;
    Scan still{};
  };
  struct Seen {
    double time;  ///< s, when robots have it
    std::vector<std::shared_ptr<const ConfigurationSpace>> spaces;
  };
  Scan scan(const Sensor& sensor, const std::vector<SceneShape>& moving) const;
  void look(double time);
  void see_until(double time);

  const Team& team_;
  const std::vector<SuiteMoving>& moving_;
  const SuiteSensing& sensing_;
  const std::map<std::string, std::string>& policies_;
  std::vector<SceneShape> solids_;
  ContinuedMap fused_;
  Snapshot latest_;
  std::shared_ptr<const BlockedSpace> occupied_;  ///< of a loaded world; null: solids tell what there is
  std::vector<Sensor> sensors_;
  std::size_t scans_ = 0;
  std::deque<Seen> seen_;  ///< the first is what robots have
};

/// @throws std::invalid_argument when a sensor stands where nothing can be seen: in an occupied voxel of
///         `map`, the sentence says which
void check_sensors(const SuiteSensing& sensing, const Snapshot& map);

}  // namespace clearway
