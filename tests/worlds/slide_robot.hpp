#pragma once

#include "planning/robot/robot.hpp"

namespace clearway::worlds {

/// A carriage that carries a box of 0.1 m along x, from 0 to 1 m; at 0 every frame of it is the map's.
inline Robot slide_robot() {
  Robot robot;
  robot.name = "slide";
  robot.joints.emplace_back().name = "x";
  robot.joints[0].kind = JointKind::prismatic;
  robot.joints[0].axis = Eigen::Vector3d::UnitX();
  robot.joints[0].upper = 1.0;
  robot.links.resize(2);
  robot.links[0].name = "rail";
  robot.links[1].name = "carriage";
  robot.links[1].parent = robot.links[1].joint = 0;
  robot.bodies.resize(1);
  robot.bodies[0].part = "carriage";
  robot.bodies[0].link = 1;
  robot.bodies[0].shape = Shape::box({0.1, 0.1, 0.1});
  robot.tip_link = 1;
  return robot;
}

}  // namespace clearway::worlds
