#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "apps/check/check_contract.hpp"

namespace clearway {

/// A path of another program: a trajectory_msgs/JointTrajectory, or what holds one as `joint_trajectory`
/// (moveit_msgs/RobotTrajectory) or as the only one in `trajectory` (DisplayTrajectory), as JSON or YAML.
struct ForeignTrajectory {
  std::vector<std::string> joints;
  std::vector<std::vector<double>> points;  ///< values of `joints`, rad or m
  std::map<std::string, double> start{};    ///< by joint, where the robot is before; may be empty
  /// Of each point its time_from_start, seconds, each above the one before; none: the file has no times, or
  /// all are 0.
  std::vector<double> times{};
  std::vector<std::vector<double>> velocities{}, accelerations{};  ///< of each point with a time; empty: none
};

/// Nothing of a file that is something else: a plan.
/// @throws std::invalid_argument naming file, field and what was expected: names given twice, a point with
/// another number of positions, velocities or accelerations, times that are missing or do not rise,
/// accelerations without velocities, no point.
std::optional<ForeignTrajectory> read_trajectory(const std::filesystem::path& file);

/// The points as a plan of one leg from the first (where the file says where the robot is before, from there)
/// to the last, in the order of the robot's joints. What the trajectory says of joints that stand still has
/// to be where they stand, and of joints that follow others (mimic) what these make of them, within 1e-4 rad
/// or m (relative, beyond 1), rates included.
/// @throws std::invalid_argument naming `file` and the joint that the trajectory or the robot lacks, or that
/// stands or follows elsewhere.
Plan plan_of_trajectory(const ForeignTrajectory& trajectory, const Robot& robot,
                        const std::filesystem::path& file);

/// A trajectory states nothing but its points: the other terms of the contract are the plan's own, and
/// count as being there by default. Notes say what is judged of one without times.
/// @param is_timed whether timed_trajectory() is judged
void adopt_terms(Contract& contract, Plan& plan, bool is_timed);

/// The plan in the order of the robot's joints, when it has the same in another order.
Plan in_order_of(const Robot& robot, Plan plan);

}  // namespace clearway
