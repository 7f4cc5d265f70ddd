#pragma once

#include "planning/constraint/control_step.hpp"
#include "planning/robot/robot.hpp"

namespace clearway::bench {

/// Distances at which obstacles begin to count and at which arms stop, metres.
inline constexpr double influence = 0.08, security = 0.01;

/// @param max_step of each joint, radians
inline DamperOptions arm_damper(const Robot& robot, double max_step) {
  return {max_step, influence, security, 0.5 * (influence - security),
          Eigen::VectorXd::Ones(static_cast<Eigen::Index>(robot.dof()))};
}

}  // namespace clearway::bench
