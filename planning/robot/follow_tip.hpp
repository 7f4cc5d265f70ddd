#pragma once

#include <string>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Where a robot that follows a hand has come to.
struct FollowedTip {
  Configuration q;          ///< puts the tip where it is wanted, else the last feasible configuration
  bool is_reached = false;  ///< the former
  std::string reason;  ///< one sentence when not reached: the joint at its limit or too slow, or how far the
                       ///< tip is off
};

/// As far as any joint may move when the tip is led from `begin` to `end` at once: 0.5 rad, or 0.5 m of a
/// full-size arm, for each 20 mm of a full-size arm or 0.1 rad, whichever are more, of the tip's way; at
/// least once.
double largest_joint_move(const Robot& robot, const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end);

/// Leads the tip of a robot from where `from` has it to `map_from_tip`, as a hand leads a virtual robot
/// (Chong et al. 2008, section 3.2). One arm configuration is kept: shoulder, elbow and wrist of a PUMA-like
/// arm; that which small steps from `from` lead to, past no singular configuration, of others. No joint moves
/// by more than largest_joint_move: near a singular configuration the robot comes after in several calls, and
/// it stops where its joints would have to jump. At the edge of the workspace it stays in its last feasible
/// configuration. Arms of fewer than six joints follow the place of the tip alone.
/// Never restarts elsewhere, so the same steps lead to the same configuration.
/// @param from within the limits
FollowedTip follow_tip(const Robot& robot, const Eigen::Isometry3d& map_from_tip, const Configuration& from);

}  // namespace clearway
