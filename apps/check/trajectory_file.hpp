#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/check/stated_terms.hpp"

namespace clearway {

/// A path of another program: a trajectory_msgs/JointTrajectory, or what holds one as `joint_trajectory`
/// (moveit_msgs/RobotTrajectory) or in the list `trajectory` (DisplayTrajectory), goals of
/// FollowJointTrajectory and ExecuteTrajectory, responses and results of MoveIt, as JSON or YAML.
struct ForeignTrajectory {
  std::vector<std::string> joints;
  std::vector<std::vector<double>> points;  ///< values of `joints`, rad or m
  std::map<std::string, double> start{};    ///< by joint, where the robot is before; may be empty
  std::optional<Eigen::Isometry3d>
      map_from_base{};  ///< where the file says that its base stands; may be none
  /// Of each point its time_from_start, seconds, each above the one before; none: the file has no times, or
  /// all are 0.
  std::vector<double> times{};
  std::vector<std::vector<double>> velocities{}, accelerations{};  ///< of each point with a time; empty: none
  std::string model{};  ///< the robot that the file is for, model_id of a DisplayTrajectory; empty: not said
  std::string field{};  ///< "trajectory[1]" of one of several, by which messages name it; else empty
  std::optional<StatedTerms> stated{};           ///< of one that we exported
  std::map<std::string, double> stated_start{};  ///< trajectory_start itself, of which `start` may know more
  std::map<std::string, double> drawn{};  ///< by joint, the farthest that draw_to_limits moved it, rad or m
};

/// The trajectories of the file, of which each but the first begins where the one before ends
/// (join_entries); none of a file that is something else: a plan.
/// @throws std::invalid_argument naming file, field and what was expected: names given twice, a point with
/// another number of positions, velocities or accelerations, times that are missing or do not rise,
/// accelerations without velocities, no point.
std::vector<ForeignTrajectory> read_trajectories(const std::filesystem::path& file);

}  // namespace clearway
