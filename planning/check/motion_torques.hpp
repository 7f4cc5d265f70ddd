#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "planning/path/motion.hpp"
#include "planning/robot/inverse_dynamics.hpp"

namespace clearway {

/// The moment and joint with the greatest share of a torque limit.
struct TorqueFinding {
  double share = 0.0, torque = 0.0;  ///< N m or N; not a number where a torque is none
  double place = 0.0;                ///< in periods from the begin: 1.5 is midway between knots 1 and 2
  Eigen::Index joint = 0;
  std::vector<std::string> overloaded;  ///< joints of whose limit gravity alone takes more than 95 %
  double held = 0.0;                    ///< the greatest share of the joint's limit that gravity alone takes
};

/// Torques at all knots, and between them at least every 8 ms, by KDL's recursive Newton-Euler on a tree,
/// with the robot's masses: not by joint_torques, which plans them.
/// @pre check_motion found the motion valid: its knots are finite and it is not too long
TorqueFinding greatest_torques(const Robot& robot, const Motion& motion, const TorqueTerms& terms);

/// The same at these moments, of times in seconds, which is what the finding's `place` is in.
TorqueFinding greatest_torques(const Robot& robot, const std::vector<std::pair<double, MotionState>>& moments,
                               const TorqueTerms& terms);

/// One sentence when a torque exceeds its limit or is not a number, else empty.
/// @param period of the finding's `place`, seconds @param excess share of a limit that rounding may take
std::string torque_fault(const Robot& robot, double period, const TorqueTerms& terms,
                         const TorqueFinding& found, double excess = 1e-6);

/// KDL's torques at one moment.
Eigen::VectorXd kdl_torques(const Robot& robot, const Configuration& q, const Eigen::VectorXd& velocity,
                            const Eigen::VectorXd& acceleration, const TorqueTerms& terms);

}  // namespace clearway
