#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// Gravity and payload of path costs.
struct CostOptions {
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2, in the robot's base frame
  double payload_mass = 0.0;                 ///< kg, full size, at the tip
};

/// Path cost in joules, Chong et al. 2008, eq. 8-9, of the full-size robot (a miniature is costed at
/// 1/scale).
class PathCost {
 public:
  /// @throws std::invalid_argument when gravity is not finite or the payload negative.
  explicit PathCost(const Robot& robot, const CostOptions& options = {});

  /// u_j: torque (Nm) or force (N) magnitude of each joint at q, Chong 2008, eq. 8: friction and gravity
  /// terms. Never < 0.
  Eigen::VectorXd generalized_forces(const Configuration& q) const;
  /// The same for who knows the poses of links of the robot as it is costed, `robot()`, at full_size(q).
  Eigen::VectorXd generalized_forces(const LinkPoses& poses) const;
  /// The gravity part alone, signed (tau_j such that it holds the arm): for comparison with rigid-body codes.
  Eigen::VectorXd gravity_torques(const Configuration& q) const;
  /// Chong 2008, eq. 9 for one step: sum over joints of mean(u_from, u_to) |dq_j|; for prismatic joints dq at
  /// full size.
  double step_cost(const Eigen::VectorXd& forces_from, const Eigen::VectorXd& forces_to,
                   const Eigen::VectorXd& dq) const;
  /// Chong 2008, eq. 9 for a path, summed per waypoint pair.
  double operator()(const std::vector<Configuration>& waypoints) const;

  /// At full size, its base at the origin: gravity is given in the base's frame.
  const Robot& robot() const { return robot_; }
  double scale() const { return scale_; }                 ///< of the robot given
  Configuration full_size(const Configuration& q) const;  ///< prismatic values, or steps, over the scale

 private:
  Robot robot_;  ///< at full size
  CostOptions options_;
  double scale_ = 1.0;
};

}  // namespace clearway
