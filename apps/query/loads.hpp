#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "datasets/descriptions/load_setup.hpp"
#include "planning/problem/pick.hpp"
#include "planning/robot/load.hpp"
#include "planning/robot/robot.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A shape as the planner has it; of meshes the convex hull. @param what begins complaints: "load 'can'"
/// @throws std::invalid_argument, DamagedFile for a mesh that cannot be read.
Shape load_shape(const LoadShape& shape, const std::string& what);

/// A load as the planner has it. @throws as load_shape
LegLoad leg_load(const LoadSetup& setup);

/// The loads of --attach. @throws std::invalid_argument for a file that is none, or a load that the robot
/// cannot carry.
std::vector<LegLoad> choose_loads(const std::vector<std::filesystem::path>& files, const Robot& robot);

/// A pick as the planner has it, put down there. @throws std::invalid_argument, DamagedFile as load_shape,
/// and for an object that the robot cannot hold.
Pick stated_pick(const PickSetup& setup, const Eigen::Isometry3d& map_from_place, const Robot& robot);

/// The pick of a file. @param place "x,y,z[,roll,pitch,yaw]" of the object afterwards, m and rad; without
/// angles it keeps those of its pose; empty: the file's
/// @throws std::invalid_argument also for no place, or an object that the robot cannot hold.
Pick choose_pick(const std::filesystem::path& file, const std::string& place, const Robot& robot);

/// The robot with all loads at once, whatever their legs: for the names of its parts.
Robot with_all_loads(const Robot& robot, const std::vector<LegLoad>& loads);

/// Policies of the robot's own parts, and those that name loads.
std::pair<Policies, std::map<std::string, Policy>> parted_policies(Policies policies,
                                                                   const std::vector<LegLoad>& loads);

/// The policies of all parts, loads included: as the space has them, of loads as given or as their holders'.
std::map<std::string, Policy> loaded_policies(const ConfigurationSpace& space,
                                              const std::vector<LegLoad>& loads,
                                              const std::map<std::string, Policy>& of_loads);

/// Why a load may be held by nothing, where all joints stand at 0 or their nearest limit: no body of what
/// carries it, or that it touches, is within 2 cm; a sentence for each such load.
std::vector<std::string> hold_notes(const Robot& robot, const std::vector<LegLoad>& loads);

/// "can on gripper, legs 2 and 3"
std::string describe_load(const LegLoad& load);

}  // namespace clearway
