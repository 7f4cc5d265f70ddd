#pragma once

#include <string>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Where a robot that follows a hand has come to.
struct FollowedTip {
  Configuration q;          ///< puts the tip where it is wanted, else the last feasible configuration
  bool is_reached = false;  ///< the former
  std::string reason;  ///< one sentence when not reached: the joint at its limit, or how far the tip is off
};

/// Leads the tip of a robot from where `from` has it to `map_from_tip`, as a hand leads a virtual robot
/// (Chong et al. 2008, section 3.2): one arm configuration is kept (shoulder, elbow and wrist of a PUMA-like
/// arm; that which small steps from `from` lead to, of others), and at the edge of the workspace the robot
/// stays in its last feasible configuration. Arms of fewer than six joints follow the place of the tip alone.
/// Never restarts elsewhere, so the same steps lead to the same configuration.
/// @param from within the limits
FollowedTip follow_tip(const Robot& robot, const Eigen::Isometry3d& map_from_tip, const Configuration& from);

}  // namespace clearway
