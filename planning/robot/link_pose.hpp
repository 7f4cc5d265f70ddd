#pragma once

// Private to what computes poses of links: forward_kinematics and LatticeChecks, bit for bit the same.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "planning/robot/robot.hpp"

namespace clearway {

/// The pose of a link against its parent when its joint (if any) stands at `q` (the joint's own value, before
/// multiplier and offset).
inline Eigen::Isometry3d pose_on_parent(const Robot& robot, const Link& link, double q) {
  if (link.joint < 0) return link.parent_from_link;
  const Eigen::Vector3d& axis = axis_of(robot, link);
  const double value = link.multiplier * q + link.offset;
  Eigen::Isometry3d pose = link.parent_from_link;
  if (kind_of(robot, link) == JointKind::revolute) {
    pose.linear() = link.parent_from_link.linear() * Eigen::AngleAxisd(value, axis).toRotationMatrix();
  } else {
    pose.translation() += link.parent_from_link.linear() * (value * axis);
  }
  return pose;
}

/// map_from_parent * parent_from_link.
inline void place_link(const Eigen::Isometry3d& map_from_parent, const Eigen::Isometry3d& parent_from_link,
                       Eigen::Isometry3d& map_from_link) {
  map_from_link.linear().noalias() = map_from_parent.linear() * parent_from_link.linear();
  map_from_link.translation().noalias() =
      map_from_parent.linear() * parent_from_link.translation() + map_from_parent.translation();
  map_from_link.makeAffine();
}

}  // namespace clearway
