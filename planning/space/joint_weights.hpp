#pragma once

#include <Eigen/Core>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// Weight w_j of each joint in joint-space lengths, ||w (q - q')||: 1 for revolute joints; for prismatic
/// joints `prismatic_scale` (rad per metre; Chong et al. 2008 scale them "within the same order of
/// magnitude" below eq. 11). prismatic_scale = 0 chooses it: 1 / reach, the most that one radian of a
/// revolute joint can move a point of the robot; 1 for a robot of prismatic joints only.
/// @throws std::invalid_argument when a robot with a prismatic joint reaches beyond 10 km and it is to be
///         chosen: the limits are absurd, and prismatic_scale has to be given.
Eigen::VectorXd joint_weights(const ConfigurationSpace& space, double prismatic_scale);

/// The most that one unit (rad or m) of each joint moves any point of a body, metres.
Eigen::VectorXd joint_reach(const ConfigurationSpace& space);

}  // namespace clearway
