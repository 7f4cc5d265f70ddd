#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/descriptions/suite.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

// What a comparison reads beside its suite's file, as SHA-256: results on other robots, problems or maps are
// of another comparison, though the suite that names them is the same.

/// Of all that plans, costs and checks rest on in a robot: joints, links, bodies, pairs that are exempt, tip,
/// inverse kinematics, accuracy.
std::string robot_digest(const Robot& robot);

/// Of the robots of an experiment's teams, each read anew. @throws as load_robot
std::string team_robots_digest(const SuiteTeams& teams);

/// Of an experiment's problems, wherever they stand: names, ends, worlds and loads with their meshes.
/// @throws std::invalid_argument for a mesh that cannot be read.
std::string problems_digest(const SuiteExperiment& experiment);

/// Of the maps that are files of a suite's worlds in which any of these experiments plans, by world.
/// @throws as map_sha256
std::map<std::string, std::string> map_digests(const Suite& suite,
                                               const std::vector<const SuiteExperiment*>& experiments);

}  // namespace clearway
