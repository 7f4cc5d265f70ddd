#include "planning/robot/robot.hpp"

#include <cmath>
#include <stdexcept>

namespace clearway {

Robot scaled(const Robot& robot, double factor) {
  if (!std::isfinite(factor) || factor <= 0.0) {
    throw std::invalid_argument("the scale of a robot must be a finite number above 0");
  }
  Robot result = robot;
  result.scale *= factor;
  result.position_accuracy *= factor;
  for (Joint& joint : result.joints) {
    if (joint.kind != JointKind::prismatic) continue;
    joint.lower *= factor;
    joint.upper *= factor;
    joint.max_velocity *= factor;
    joint.max_acceleration *= factor;
    joint.max_jerk *= factor;
    joint.step *= factor;
  }
  for (Link& link : result.links) {
    link.parent_from_link.translation() *= factor;
    link.center_of_mass *= factor;
    link.mass *= factor * factor * factor;
    if (link.joint < 0) continue;
    const JointKind master = result.joints[static_cast<std::size_t>(link.joint)].kind;
    if (master == JointKind::prismatic) link.multiplier /= factor;
    if (kind_of(result, link) == JointKind::prismatic) link.multiplier *= factor, link.offset *= factor;
  }
  for (Body& body : result.bodies) {
    body.link_from_shape.translation() *= factor;
    body.shape = body.shape.scaled(factor);
    for (Sphere& sphere : body.cover) {
      sphere.center *= factor;
      sphere.radius *= factor;
    }
  }
  result.link_from_tip.translation() *= factor;
  for (Load& load : result.loads) {
    load.link_from_load.translation() *= factor;
    load.shape = load.shape.scaled(factor);
  }
  return result;
}

}  // namespace clearway
