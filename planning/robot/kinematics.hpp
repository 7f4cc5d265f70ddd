#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "planning/robot/robot.hpp"

namespace clearway {

using Configuration = Eigen::VectorXd;
using LinkPoses = std::vector<Eigen::Isometry3d>;

/// Poses of all links in the map frame, `map_from_link[i]`. @pre q.size() == robot.dof()
void forward_kinematics(const Robot& robot, const Configuration& q, LinkPoses& map_from_link);
/// @throws std::invalid_argument for another number of joint values
LinkPoses forward_kinematics(const Robot& robot, const Configuration& q);

/// map_from_tip at q. @throws std::invalid_argument for another number of joint values
Eigen::Isometry3d tip_pose(const Robot& robot, const Configuration& q);

/// Linear (rows 0-2) and angular (rows 3-5) velocity Jacobian, map frame, of the point `point` (map frame)
/// that moves with `link`, given the link poses at q.
Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const Robot& robot, const LinkPoses& map_from_link,
                                                  int link, const Eigen::Vector3d& point);

/// Empty when q has the right size, is finite and keeps the joint limits and largest_joint_value; else one
/// sentence naming the joint, the value and the limit.
std::string limit_violation(const Robot& robot, const Configuration& q);

/// ", as joint 'finger_2' follows 'finger_1' and ends at 0.04 m": of a limit that the joint has from one that
/// follows it (Joint::lower_follower); else empty.
std::string whose_limit(const Robot& robot, std::size_t joint, bool is_upper);

/// @throws std::invalid_argument unless q is one finite value for each joint of the robot
/// @param what names it in the sentence
void require_configuration(const Robot& robot, const Eigen::VectorXd& q, const std::string& what);

/// Whether whole turns of a joint leave every link where it is: it turns, and what follows it makes whole
/// turns, too, and does not slide. Limits are not asked. @pre joint < robot.dof()
bool is_same_after_turns(const Robot& robot, std::size_t joint);

/// Whether the joint moves the tip: it is on the way from the base to it. @pre joint < robot.dof()
bool moves_tip(const Robot& robot, std::size_t joint);

/// The same of a joint that also turns without end. @pre joint < robot.dof()
bool repeats_after_turns(const Robot& robot, std::size_t joint);

/// The same pose of the robot as at q, with joints that repeat turned by whole turns to be nearest to `near`.
/// @pre q.size() == near.size() == robot.dof()
Configuration by_whole_turns(const Robot& robot, Configuration q, const Configuration& near);

/// Tolerances and effort of inverse kinematics.
struct IkOptions {
  double position_tolerance = 1e-6;     ///< metres
  double orientation_tolerance = 1e-6;  ///< radians
  int max_iterations = 200;             ///< of each start
  int restarts = 16;                    ///< seeded random restarts of the numeric solver
  std::uint64_t seed = 1;               ///< of the restarts
  bool position_only = false;           ///< ignore orientation (arms with fewer than 6 joints)
  double free_distance = 0.0;           ///< metres that the tip's origin may be from the pose
  double free_turn = 0.0;               ///< radians by which its orientation may differ
  std::optional<int> free_axis = {};    ///< 0, 1, 2: the tip's own x, y or z, about which it may turn

  bool leaves_freedom() const { return free_distance > 0.0 || free_turn > 0.0 || free_axis; }
};

/// A configuration that puts the tip at `map_from_tip`, near `near`; within limits. Geometric for "puma"
/// (Craig 1989, the arm configuration of `near` is kept), damped least squares with limits otherwise, and for
/// poses that leave something free.
/// Empty when out of reach, for "puma" also when the pose asks for another arm configuration than that of
/// `near`; goal_configurations() tries them all. Empty as well for poses and `near` that are not finite.
/// @throws std::invalid_argument for `near` of a wrong size, a free_axis that is none, and for a robot whose
/// file says "puma" that is no such arm.
std::optional<Configuration> inverse_kinematics(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                                                const Configuration& near, const IkOptions& options = {});

/// All geometric solutions of a PUMA-like 6R arm (spherical wrist) within limits, up to 8, in fixed order.
std::vector<Configuration> puma_inverse_kinematics(const Robot& robot, const Eigen::Isometry3d& map_from_tip);

}  // namespace clearway
