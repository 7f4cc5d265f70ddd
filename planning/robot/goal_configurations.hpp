#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The robot with its tip at the frame of a link. Its inverse kinematics are then numeric, as geometric ones
/// are made for the tip of the robot's settings. @throws std::invalid_argument for a link that it does not
/// have, naming the nearest one, or one that no joint moves.
Robot with_tip(const Robot& robot, const std::string& link);

/// How many joints move the tip: those of a hand beyond it do not.
std::size_t joints_of_tip(const Robot& robot);

/// Where the tip shall be, and what of it may differ.
struct GoalPose {
  Eigen::Isometry3d map_from_tip = Eigen::Isometry3d::Identity();
  double position_tolerance = 0.0;  ///< m, >= 0, how far from there the tip's origin may be
  double turn_tolerance = 0.0;      ///< rad, 0 to pi, the angle by which its orientation may differ
  std::optional<int> free_axis{};   ///< 0, 1, 2: the tip's own x, y or z, about which it may turn as it likes

  bool is_exact() const { return position_tolerance == 0.0 && turn_tolerance == 0.0 && !free_axis; }
};

/// Whether a tip there keeps what the goal asks for: within 1e-5 m and rad.
bool reaches(const GoalPose& goal, const Eigen::Isometry3d& map_from_tip);

/// Poses that keep what the goal asks for, itself first: then, about its free axis, turns 15 degrees apart,
/// the least first; then, within its tolerances, `count` that are spread evenly (Halton). The same at each
/// call.
std::vector<Eigen::Isometry3d> poses_of(const GoalPose& goal, int count = 96);

/// Configurations within limits that put the tip at `map_from_tip`: all branches of a PUMA-like arm; of six
/// turning joints with a spherical wrist both ways of the wrist, in closed form, for each place of the first
/// three joints that damped least squares find; else those that these find; from `near` and from `starts`
/// seeded random configurations. Each once
/// (differing by more than 1e-3 in some joint), of joints that turn more than once the turn nearest to
/// `near`. Joints that do not move the tip stay as `near` has them. Nearest to `near` first, by the largest
/// difference of a joint.
/// @throws std::invalid_argument, as the next does, unless `near` is one finite value for each joint
std::vector<Configuration> goal_configurations(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                                               const Configuration& near, int starts = 64,
                                               std::uint64_t seed = 1);

/// Configurations within limits that keep what the goal asks for, of a goal that leaves something open: each
/// where damped least squares first meet it from `near` and from `starts` seeded random configurations. An
/// arm of fewer than six joints may meet it at single turns and places alone, which poses drawn from it miss.
/// Order and distinctness as above.
std::vector<Configuration> goal_configurations(const Robot& robot, const GoalPose& goal,
                                               const Configuration& near, int starts = 64,
                                               std::uint64_t seed = 1);

}  // namespace clearway
