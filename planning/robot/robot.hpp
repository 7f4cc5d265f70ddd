#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mapping/voxels/sphere.hpp"
#include "mapping/voxels/voxel_state.hpp"
#include "planning/geometry/shape.hpp"
#include "planning/robot/load.hpp"

namespace clearway {

enum class JointKind { revolute, prismatic };

/// An actuated joint. Units: radians or metres.
struct Joint {
  std::string name;
  JointKind kind = JointKind::revolute;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit, in the frame of the joint's link
  double lower = 0.0, upper = 0.0;                  ///< limits; for an unlimited joint -infinity, infinity
  double max_velocity = 0.0;                        ///< rad/s or m/s; 0 when the URDF gives none
  double max_acceleration = 0.0;                    ///< rad/s^2 or m/s^2; 0 when URDF and settings give none
  double max_jerk = 0.0;                            ///< rad/s^3 or m/s^3; 0 when URDF and settings give none
  double friction = 0.0;                            ///< mu_j of Chong et al. 2008, eq. 8
  double step = 0.0;  ///< epsilon_j, Chong 2008, eq. 4: default perturbation of the beam search
  /// Of a limit that is narrower than the joint's own, because a joint that follows it (mimic) ends there:
  /// that one's name; else empty.
  std::string lower_follower{}, upper_follower{};
};

/// Values beyond it are refused, of joints without limits, too: there angles lose their digits.
constexpr double largest_joint_value = 1e6;

/// Whether the joint turns without end, so that whole turns lead to the same pose.
inline bool is_endless(const Joint& joint) {
  return joint.kind == JointKind::revolute && std::isinf(joint.lower) && std::isinf(joint.upper);
}

/// A rigid link. Links are stored parents first; link 0 is the root.
struct Link {
  std::string name;
  int parent = -1;                                                     ///< index, -1 for the root
  Eigen::Isometry3d parent_from_link = Eigen::Isometry3d::Identity();  ///< at joint value 0
  int joint = -1;  ///< actuated joint that moves this link against its parent; -1: fixed
  double multiplier = 1.0, offset = 0.0;  ///< joint value used = multiplier * q + offset (URDF mimic)
  bool is_held = false;      ///< hangs on a joint that could move it and is held still (HeldJoint)
  std::string joint_name{};  ///< of the joint above it in the robot's file, fixed or mimic ones too
  double mass = 0.0;         ///< kg
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();  ///< link frame
  /// Where a mimic joint's axis is another than its master's, each in its own link's frame: that axis, a unit
  /// vector. Else 0, and the joint's axis is that of the link as well.
  Eigen::Vector3d own_axis = Eigen::Vector3d::Zero();
  /// Where a mimic joint slides and its master turns, or the other way round: its own kind. The multiplier is
  /// then m per rad, or rad per m.
  std::optional<JointKind> own_kind{};
};

/// One convex collision body on a link. `part` is the name by which policies and painted volumes refer to it.
struct Body {
  std::string part;
  int link = 0;
  Eigen::Isometry3d link_from_shape = Eigen::Isometry3d::Identity();
  Shape shape = Shape::sphere(1.0);
  std::vector<Sphere> cover;  ///< spheres in the LINK frame whose union contains the body
};

/// Who says where a held joint stands.
enum class HoldSource { asked, settings, default_state, zero };

/// A joint that could move, but stands still: outside of the planning group, or fixed. It is no part of
/// configurations.
struct HeldJoint {
  std::string name;
  double value = 0.0;  ///< rad or m at full size, whatever the robot's scale
  HoldSource source = HoldSource::zero;
};

/// A configuration with a name (SRDF group_state); values in rad or m, full size.
struct NamedState {
  std::string name;
  std::map<std::string, double> values;  ///< by joint
  /// Of joints that two groups' states of this name have at two values, a sentence each; the planning group's
  /// own is no such group.
  std::map<std::string, std::string> doubts{};
  std::set<std::string>
      aside{};  ///< joints that other groups' states alone name, beside one of the group's own
};

/// Who says where a robot's tip is: its settings (or who made it), its SRDF, or nobody but its joints.
enum class TipSource { stated, srdf, joints };

/// Of a tip that nobody chose: what else it could be (tip_of_joints).
struct TipChoice {
  TipSource source = TipSource::stated;
  std::vector<std::string> others{};  ///< tips of other arms
  std::string finger_joint{};  ///< taken for a gripper's because it slides little, and alone; empty: none
};

/// Of a robot whose settings state none, full size: makers state repeatability, some 0.1 mm, but of the
/// accuracy of a pose that was computed and not taught only that it is several times worse. Metres.
constexpr double default_position_accuracy = 1e-3;

/// How many times as large as its URDF a robot may be: as wide as URDFs are read, so that sizes stay such
/// that no sum or product of them loses digits.
constexpr double least_scale = 1e-6, most_scale = 1e3;

/// A robot: a kinematic tree with bodies, masses and limits, at some scale and place. Plain data.
struct Robot {
  std::string name;
  std::vector<Joint> joints;  ///< actuated, in configuration order
  std::vector<Link> links;
  std::vector<Body> bodies;
  std::vector<std::pair<int, int>> exempt;  ///< pairs of bodies (first < second) never tested for contact
  int tip_link = 0;                         ///< frame of the end effector, W'
  Eigen::Isometry3d link_from_tip = Eigen::Isometry3d::Identity();  ///< tip frame on tip_link
  TipChoice tip_choice{};
  std::vector<std::string> critical_parts;     ///< parts that `painted` is the default policy for
  std::string inverse_kinematics = "numeric";  ///< "numeric" or "puma" (geometric, Craig)
  Eigen::Isometry3d map_from_base = Eigen::Isometry3d::Identity();
  double position_accuracy = default_position_accuracy;  ///< metres, at this scale: the default padding
  double scale = 1.0;  ///< against the full-size robot of the URDF; path costs are of the full-size robot
  std::filesystem::path source;
  std::string model{};                         ///< its name inside the URDF
  std::map<std::string, std::string> xacro{};  ///< arguments with which its .xacro was expanded
  std::filesystem::path srdf{};                ///< that was read with it; empty: none
  std::string group{};            ///< planning group of the SRDF whose joints move; empty: all joints
  std::vector<HeldJoint> held{};  ///< the others, by name
  std::vector<HeldJoint> held_followers{};  ///< joints that mimic one of these, where that has them
  std::vector<std::string>
      standing{};  ///< links that may touch what the robot stands on while no joint moves them
  std::vector<NamedState> states{};      ///< of the SRDF, by name
  std::vector<std::string> only_seen{};  ///< links with a shape to look at and none to collide: not checked
  std::vector<Load> loads{};             ///< that ride on it (with_load): the last links and bodies, one each

  std::size_t dof() const { return joints.size(); }
};

/// The axis about or along which a link's joint moves it, unit vector, link frame. @pre a joint moves it
inline const Eigen::Vector3d& axis_of(const Robot& robot, const Link& link) {
  return link.own_axis.isZero(0.0) ? robot.joints[static_cast<std::size_t>(link.joint)].axis : link.own_axis;
}

/// How a link's joint moves it: a mimic joint may be of another kind than its master. @pre a joint moves it
inline JointKind kind_of(const Robot& robot, const Link& link) {
  return link.own_kind ? *link.own_kind : robot.joints[static_cast<std::size_t>(link.joint)].kind;
}

/// The same robot `factor` times as large: lengths, prismatic limits and accuracy by factor, masses by
/// factor^3.
Robot scaled(const Robot& robot, double factor);

}  // namespace clearway
