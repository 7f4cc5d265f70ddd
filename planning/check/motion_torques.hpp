#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planning/path/motion.hpp"
#include "planning/robot/inverse_dynamics.hpp"

namespace clearway {

/// The knot and joint with the greatest share of a torque limit.
struct TorqueFinding {
  double share = 0.0, torque = 0.0;  ///< N m or N
  std::size_t knot = 0;
  Eigen::Index joint = 0;
  std::vector<std::string> overloaded;  ///< joints that gravity alone takes 95 % of the limit of: not counted
};

/// Torques at all knots by KDL's recursive Newton-Euler on a tree, with the robot's masses: not by
/// joint_torques, which plans them.
TorqueFinding greatest_torques(const Robot& robot, const Motion& motion, const TorqueTerms& terms);

/// One sentence when a torque exceeds its limit, else empty.
std::string torque_fault(const Robot& robot, const Motion& motion, const TorqueTerms& terms,
                         const TorqueFinding& found);

/// KDL's torques at one moment.
Eigen::VectorXd kdl_torques(const Robot& robot, const Configuration& q, const Eigen::VectorXd& velocity,
                            const Eigen::VectorXd& acceleration, const TorqueTerms& terms);

}  // namespace clearway
