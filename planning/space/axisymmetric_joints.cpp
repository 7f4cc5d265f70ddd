#include "planning/space/axisymmetric_joints.hpp"

#include "planning/robot/link_pose.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

constexpr double tolerance = 1e-15;  ///< of the sizes involved

/// Whether turning about the axis through the origin maps the shape onto itself.
bool is_symmetric(const Shape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& axis) {
  if (!shape.is_axial()) return false;
  const Eigen::Vector3d center = pose.translation();
  if (center.cross(axis).norm() > tolerance * (center.norm() + shape.bounding_radius())) return false;
  return (shape.is_rounded() && shape.length() == 0.0) ||
         pose.linear().col(2).cross(axis).norm() <= tolerance;
}

void carry_before_axisymmetric_joints(const Robot& robot, Body& body) {
  Eigen::Isometry3d link_from_old = Eigen::Isometry3d::Identity();
  int at = body.link;
  for (const Link* link = &robot.links[static_cast<std::size_t>(at)]; link->parent >= 0;
       link = &robot.links[static_cast<std::size_t>(at)]) {
    const bool turns = link->joint >= 0;
    if (turns) {
      const bool is_idle =
          kind_of(robot, *link) == JointKind::revolute &&
          is_symmetric(body.shape, link_from_old * body.link_from_shape, axis_of(robot, *link));
      if (!is_idle || !is_moved(robot, link->parent)) return;
    }
    link_from_old = pose_on_parent(robot, *link, 0.0) * link_from_old;
    at = link->parent;
    if (!turns) continue;
    body.link = at;
    body.link_from_shape = link_from_old * body.link_from_shape;
    for (Sphere& sphere : body.cover) sphere.center = link_from_old * sphere.center;
    link_from_old.setIdentity();
  }
}

}  // namespace

Robot without_axisymmetric_joints(Robot robot) {
  for (Body& body : robot.bodies) carry_before_axisymmetric_joints(robot, body);
  return robot;
}

}  // namespace clearway
