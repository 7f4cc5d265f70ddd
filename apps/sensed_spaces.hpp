#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "datasets/suite.hpp"
#include "mapping/free_space_map.hpp"
#include "planning/team.hpp"

namespace clearway {

/// What a team's robots know of the map while sensors look, time after time, at a world and at what moves in
/// it: scans are fused by rays, distance fields are brought up to date where something changed, and robots
/// get the map when the latency is over. Between two scans they go on with the last one.
class SensedSpaces {
 public:
  /// Sees the world, and where sensed things are at time 0, at once. Keeps references to all but `world`.
  /// @param moving of the team; those that are not sensed do not count
  SensedSpaces(const Team& team, const std::vector<SuiteMoving>& moving, const SuiteSensing& sensing,
               const SuiteWorld& world, const std::map<std::string, std::string>& policies);

  /// The space of robot number `robot` at `time`; times must not go back.
  std::shared_ptr<const ConfigurationSpace> at(std::size_t robot, double time);

  const Snapshot& map() const { return latest_; }

 private:
  struct Seen {
    double time;  ///< s, when robots have it
    std::vector<std::shared_ptr<const ConfigurationSpace>> spaces;
  };
  void look(double time);
  void see_until(double time);

  const Team& team_;
  const std::vector<SuiteMoving>& moving_;
  const SuiteSensing& sensing_;
  const std::map<std::string, std::string>& policies_;
  std::vector<SceneShape> solids_;
  FreeSpaceMap fused_;
  Snapshot latest_;
  std::size_t scans_ = 0;
  std::deque<Seen> seen_;  ///< the first is what robots have
};

}  // namespace clearway
