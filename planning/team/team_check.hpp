#pragma once

#include <string>

#include "planning/team/team.hpp"

namespace clearway {

/// What the independent check of a run found.
struct TeamVerdict {
  bool is_apart =
      false;  ///< nothing touched at any time: robots, obstacles, themselves, the map at the start
  bool robots_are_apart = false;  ///< the same without obstacles
  double least_separation = 0.0;  ///< between robots, and of robots from obstacles, at ANY time: certified,
                                  ///< m; at most `cap`, short of the true one by 0.1 mm at most; of two
                                  ///< bodies that both stand still contact alone counts, as 0
  double between_robots = 0.0;    ///< the same of robots from each other alone
  double time = 0.0;              ///< when
  std::string between;            ///< "left/load and right/forearm"; empty when all stayed `cap` apart
  std::string contact;            ///< the first contact with the map or within a robot; empty when none
  double greatest_speed_share = 0.0;         ///< of a joint's velocity limit
  double greatest_acceleration_share = 0.0;  ///< of the acceleration limit, from period to period
};

/// Re-checks a run in code that the robots do not share: KDL kinematics, certified FCL distances
/// (path_check), conservative advancement over time; joints and obstacles move evenly between samples. Each
/// robot by itself is checked against the map that it started with, and against itself, by check_path.
/// @param cap distances beyond it are not looked for, m; at least 1 mm
TeamVerdict check_team(const Team& team, const TeamRun& run, double max_acceleration, double cap);

}  // namespace clearway
