#pragma once

// Not part of the installed library.

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// A point of a link and where it is to go.
struct PointTarget {
  int link = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< link frame, metres
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< map frame, metres
  double tolerance = 1e-3;                           ///< metres
};

/// Moves `q`, little by little and within the joints' limits, by the least joint motion that brings the point
/// to its target (damped least squares, Wampler 1986; 3 rows). Joints at a limit leave it to the others.
/// False when it is not there after so many steps; `q` is then where they ended.
/// @param poses memory; afterwards the poses of the links one step before `q`, or at it where it is true
bool bring_point(const Robot& robot, const PointTarget& wanted, int most_steps, Configuration& q,
                 LinkPoses& poses);

}  // namespace clearway
