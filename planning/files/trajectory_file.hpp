#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "planning/files/plan_file.hpp"
#include "planning/path/trajectory.hpp"

namespace clearway {

/// A form in which a robot's controller takes a trajectory.
struct TrajectoryFormat {
  std::string_view name;
  std::string_view description;
  /// Empty, or why the robot cannot be driven so: one sentence.
  std::string (*refusal)(const Robot& robot);
  /// The text of the file; `plan` is where the trajectory comes from, named in its heading.
  std::string (*write)(const Robot& robot, const Plan& plan, const Trajectory& trajectory);
};

/// The explicit table of formats:
/// - `ros`: YAML of a trajectory_msgs/JointTrajectory (ROS 2 field names), frame_id the robot's root link;
/// - `urscript`: a program `clearway_path()` for Universal Robots controllers that streams the points with
///   servoj; for robots of six revolute joints. It stops with a message when the arm is not within 0.01 rad
///   of the start. servoj follows with a lag and rounds corners by what `lookahead_time` smooths. Where the
///   path stops, as at goals, events and its end, the program holds the arm until it has caught up within
///   0.001 rad, at most 2 s; it stops with a message when the arm is then not within 0.01 rad.
/// - `ros-json`: the message of `ros` as JSON;
/// - `json`: arrays of times, positions, velocities and accelerations, with robot, planner and map;
/// - `csv`: a table with a heading: time, then positions, velocities and accelerations of all joints.
/// Events (a load is grasped or let go) are comments of `ros`, calls of functions that the user fills of
/// `urscript`, an array of `json`, a last column of `csv`; the message of `ros-json` has no place for them,
/// and the arm rests there all the same. A load that rides all the way is a comment of `ros` and `urscript`,
/// a key of `json`; `ros-json` and `csv` have no place for it. So is a payload, and a gravity that is not the
/// usual one. Joints are the robot's own: those of its
/// planning group. Accelerations are written where the trajectory has them. A smooth motion (trajectory_of)
/// goes by cubics between its points: controllers that interpolate positions and velocities by cubics, or
/// accelerations too by quintics, follow the proved curve itself. servoj is given the positions at their
/// rate; between them the robot's own controller interpolates, and its lag and smoothing are not part of the
/// proof. Every number reads back to the same double.
const std::vector<TrajectoryFormat>& trajectory_formats();

/// The format `name` for the robot. @throws std::invalid_argument when there is no such format, naming the
/// nearest one, or the robot cannot be driven so.
const TrajectoryFormat& trajectory_format(std::string_view name, const Robot& robot);

}  // namespace clearway
