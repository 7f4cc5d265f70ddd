#pragma once

#include <cstddef>
#include <vector>

#include "apps/pages/report_page.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/robot/inverse_dynamics.hpp"

namespace clearway {

/// Gives `plan` time: waypoints, speeds, accelerations and limits of the motion that rests before its first
/// sample, some 1,500 of them at most, evenly in time but for the last one. Speeds are those at the
/// waypoints; between two of them the greatest acceleration is kept. Returns which samples are shown.
/// @param robot of all joints @param velocities of each position, rad/s and m/s
/// @param period s between two positions
std::vector<std::size_t> show_motion(PagePlan& plan, const Robot& robot,
                                     const std::vector<Configuration>& positions,
                                     const std::vector<Eigen::VectorXd>& velocities, double period,
                                     double max_acceleration);

/// The same for what a controller is given for a path (time_parameterize with its defaults), with figures.
/// Paths of fewer than two different waypoints, and those that take more than 20 minutes, are left as they
/// are: nothing is returned.
std::vector<std::size_t> show_motion(PagePlan& plan, const Robot& robot,
                                     const std::vector<Configuration>& path);

/// The same of such a motion that is given.
std::vector<std::size_t> show_trajectory(PagePlan& plan, const Robot& robot, const Trajectory& trajectory);

/// The same of the motion that a plan is given with it, at its knots: limits are the robot's own. Torques
/// (joint_torques) are shown where some joint has a limit of them, see torque_terms.
/// @param load that torques are reckoned with, at the robot's scale @param loads that ride on legs besides
/// @throws std::invalid_argument as torque_terms
std::vector<std::size_t> show_smooth_motion(PagePlan& plan, const Robot& robot, const PlannedMotion& planned,
                                            const JointLoad& load, const std::vector<LegLoad>& loads = {});

}  // namespace clearway
