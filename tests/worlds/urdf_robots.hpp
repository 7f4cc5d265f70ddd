#pragma once

// Small robots that no shipped one stands for, as files: what a factor, a sign or a limit does to a bound
// shows in them and not in arms whose every joint turns one link by its own angle.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "planning/robot/robot.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway::worlds {

/// A robot read from a URDF that exists as long as this object.
class UrdfRobot {
 public:
  UrdfRobot(const std::string& name, const std::string& links_and_joints)
      : robot_(load_robot(
            folder_.write(name + ".urdf", "<robot name='" + name + "'>" + links_and_joints + "</robot>"))) {}

  const Robot& robot() const { return robot_; }

 private:
  TemporaryFolder folder_;
  Robot robot_;
};

inline std::string urdf_link(const std::string& name, const std::string& xyz, const std::string& shape) {
  return "<link name='" + name + "'><collision><origin xyz='" + xyz + "' rpy='0 1.5707963267948966 0'/>" +
         "<geometry>" + shape + "</geometry></collision></link>";
}

/// `inside`: limit, mimic.
inline std::string urdf_joint(const std::string& name, const std::string& type, const std::string& parent,
                              const std::string& child, const std::string& xyz, const std::string& axis,
                              const std::string& inside) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/><origin xyz='" + xyz + "'/><axis xyz='" + axis + "'/>" + inside + "</joint>";
}

inline std::string urdf_limit(double lower, double upper) {
  return "<limit lower='" + std::to_string(lower) + "' upper='" + std::to_string(upper) +
         "' effort='1' velocity='1'/>";
}

/// An arm of two turning joints, "shoulder" and "elbow", with a finger that slides by "grip"; as URDF.
inline std::string arm_with_finger() {
  const std::string sphere = "<sphere radius='0.05'/>";
  return "<robot name='arm'><link name='base'/>" + urdf_link("upper", "0.2 0 0", sphere) +
         urdf_link("lower", "0.2 0 0", sphere) + urdf_link("finger", "0.1 0 0", sphere) +
         urdf_joint("shoulder", "revolute", "base", "upper", "0 0 0", "0 0 1", urdf_limit(-2, 2)) +
         urdf_joint("elbow", "revolute", "upper", "lower", "0.4 0 0", "0 0 1", urdf_limit(-2, 2)) +
         urdf_joint("grip", "prismatic", "lower", "finger", "0.4 0 0", "1 0 0", urdf_limit(0, 0.1)) +
         "</robot>";
}

/// An arm in the plane z = 0 whose second link turns four times as far as the joint that turns the first; a
/// post stands on its base, which the second link can touch.
inline UrdfRobot whip() {
  const std::string rod = "<capsule radius='0.03' length='0.4'/>";
  return {"whip",
          urdf_link("post", "0.35 0.3 0", "<sphere radius='0.05'/>") + urdf_link("handle", "0.25 0 0", rod) +
              urdf_link("lash", "0.25 0 0", rod) +
              urdf_joint("swing", "revolute", "post", "handle", "0 0 0", "0 0 1", urdf_limit(-1.5, 1.5)) +
              urdf_joint("follow", "continuous", "handle", "lash", "0.5 0 0", "0 0 1",
                         "<mimic joint='swing' multiplier='4' offset='0.2'/>")};
}

/// A boom that turns, with a slide that reaches far back and hardly ahead, and on it a hand that slides as
/// far to the side, the other way round, by a mimic joint; a post stands where the hand can touch it.
inline UrdfRobot telescope() {
  const std::string sphere = "<sphere radius='0.06'/>";
  return {"telescope",
          urdf_link("post", "-0.7 -0.6 0", "<sphere radius='0.08'/>") +
              urdf_link("boom", "0 0 0", "<sphere radius='0.05'/>") + urdf_link("slide", "0 0 0", sphere) +
              urdf_link("hand", "0 0 0", sphere) +
              urdf_joint("turn", "revolute", "post", "boom", "0 0 0", "0 0 1", urdf_limit(-3, 3)) +
              urdf_joint("reach", "prismatic", "boom", "slide", "-0.2 0 0", "1 0 0", urdf_limit(-1.2, 0.05)) +
              urdf_joint("side", "prismatic", "slide", "hand", "0 0.15 0", "0 1 0",
                         urdf_limit(-0.2, 5.0) + "<mimic joint='reach' multiplier='-1.5' offset='0.1'/>")};
}

/// A boom on which a rack slides out as the boom turns, and on the rack a lift, whose paddle turns as it
/// slides: mimic joints of another kind than their masters. A post stands where rack and paddle can touch it.
inline UrdfRobot rack_and_pinion() {
  const std::string sphere = "<sphere radius='0.06'/>";
  return {"rack_and_pinion",
          urdf_link("post", "0.5 0.4 0", "<sphere radius='0.08'/>") +
              urdf_link("boom", "0 0 0", "<sphere radius='0.05'/>") + urdf_link("rack", "0 0 0", sphere) +
              "<link name='lift'/>" +
              urdf_link("paddle", "0.15 0 0", "<capsule radius='0.03' length='0.2'/>") +
              urdf_joint("turn", "revolute", "post", "boom", "0 0 0", "0 0 1", urdf_limit(-1.5, 1.5)) +
              urdf_joint("slide", "prismatic", "boom", "rack", "0.1 0 0", "1 0 0",
                         urdf_limit(0.0, 0.8) + "<mimic joint='turn' multiplier='0.25' offset='0.4'/>") +
              urdf_joint("rise", "prismatic", "rack", "lift", "0 0 0", "0 0 1", urdf_limit(-0.25, 0.3)) +
              urdf_joint("swing", "revolute", "lift", "paddle", "0 0 0", "0 0 1",
                         urdf_limit(-2, 1.5) + "<mimic joint='rise' multiplier='5' offset='0.2'/>")};
}

/// Two arms beside each other on one base, which meet between them; siblings, each with a joint of its own.
inline UrdfRobot scissors() {
  const std::string blade = "<capsule radius='0.03' length='0.6'/>";
  return {
      "scissors",
      "<link name='base'/>" + urdf_link("left", "0.35 0 0", blade) + urdf_link("right", "-0.35 0 0", blade) +
          urdf_joint("left_turn", "revolute", "base", "left", "-0.5 0 0", "0 0 1", urdf_limit(-1.5, 1.5)) +
          urdf_joint("right_turn", "revolute", "base", "right", "0.5 0 0", "0 0 1", urdf_limit(-1.5, 1.5))};
}

/// Two balls on links of which the upper one's joint follows the lower one's endless joint: "a" at `a_at` on
/// l1, "b" at `b_at` on l2, a metre higher.
inline UrdfRobot geared(double multiplier, const std::string& radius, const std::string& a_at,
                        const std::string& b_at) {
  const std::string ball = "<sphere radius='" + radius + "'/>";
  return {"geared", urdf_link("base", "0 0 -5", ball) + urdf_link("l1", "0 0 5", ball) +
                        urdf_link("l2", "0 0 9", ball) + urdf_link("a", "0 0 0", ball) +
                        urdf_link("b", "0 0 0", ball) +
                        urdf_joint("j1", "continuous", "base", "l1", "0 0 0", "0 0 1", "") +
                        urdf_joint("j2", "continuous", "l1", "l2", "0 0 1", "0 0 1",
                                   "<mimic joint='j1' multiplier='" + std::to_string(multiplier) + "'/>") +
                        urdf_joint("fa", "fixed", "l1", "a", a_at, "0 0 1", "") +
                        urdf_joint("fb", "fixed", "l2", "b", b_at, "0 0 1", "")};
}

/// A gantry along x, y and z with a palm that turns about z and two fingers under it, the second of which
/// follows the first: 0.02 m more than the joint `grip` from the middle. Its tip is the frame between them.
inline UrdfRobot gripper() {
  const std::string finger = "<box size='0.08 0.01 0.02'/>";  // turned as urdf_link turns it: 0.08 along z
  return {"gripper",
          urdf_link("base", "0 0 1.6", "<sphere radius='0.05'/>") + "<link name='x'/><link name='y'/>" +
              urdf_link("mast", "0 0 0.25", "<box size='0.3 0.04 0.04'/>") +
              urdf_link("palm", "0 0 0", "<box size='0.02 0.14 0.04'/>") +
              urdf_link("left", "0 0 0", finger) + urdf_link("right", "0 0 0", finger) +
              "<link name='tcp'/>" +
              urdf_joint("jx", "prismatic", "base", "x", "0 0 0", "1 0 0", urdf_limit(-1, 1)) +
              urdf_joint("jy", "prismatic", "x", "y", "0 0 0", "0 1 0", urdf_limit(-1, 1)) +
              urdf_joint("jz", "prismatic", "y", "mast", "0 0 0", "0 0 1", urdf_limit(0, 1)) +
              urdf_joint("turn", "revolute", "mast", "palm", "0 0 0", "0 0 1", urdf_limit(-1.5, 1.5)) +
              urdf_joint("grip", "prismatic", "palm", "left", "0 0.02 -0.06", "0 1 0", urdf_limit(0, 0.04)) +
              urdf_joint("follow", "prismatic", "palm", "right", "0 -0.02 -0.06", "0 -1 0",
                         urdf_limit(0, 0.04) + "<mimic joint='grip'/>") +
              urdf_joint("middle", "fixed", "palm", "tcp", "0 0 -0.08", "0 0 1", "")};
}

/// A tool of which one body, a box, sweeps a ring about the joint or slides along x, past a ball that stands
/// beside the base, `post` from the axis.
class Ring {
 public:
  Ring(const std::string& kind, double lower, double upper, double post, double turned)
      : slides_(kind == "prismatic"),
        lower_(lower),
        upper_(upper),
        post_(post * std::cos(turned), post * std::sin(turned)),
        robot_("ring", urdf_link("base", "0 0 -5", "<sphere radius='0.05'/>") +
                           urdf_link("arm", "0 0 5", "<sphere radius='0.05'/>") +
                           urdf_link("post", "0 0 0", "<sphere radius='0.05'/>") +
                           urdf_link("tool", "0.4 0 0", "<box size='0.04 0.06 0.2'/>") +
                           urdf_joint("p", "fixed", "base", "post",
                                      std::to_string(post_.x()) + " " + std::to_string(post_.y()) + " 0",
                                      "0 0 1", "") +
                           urdf_joint("j", kind, "base", "arm", "0 0 0", slides_ ? "1 0 0" : "0 0 1",
                                      urdf_limit(lower, upper)) +
                           urdf_joint("t", "fixed", "arm", "tool", "0 0 0", "0 0 1", "")) {}

  const Robot& robot() const { return robot_.robot(); }

  std::pair<int, int> post_and_tool() const {
    const auto body = [&](const std::string& part) {
      const auto& bodies = robot().bodies;
      return static_cast<int>(
          std::find_if(bodies.begin(), bodies.end(), [&](const Body& one) { return one.part == part; }) -
          bodies.begin());
    };
    return std::minmax(body("post"), body("tool"));
  }

  /// Of the ball's surface to the box, at 4001 places of the joint.
  double least_distance() const {
    double least = 1.0;
    for (int k = 0; k <= 4000; ++k) {
      const double value = lower_ + (upper_ - lower_) * k / 4000.0;
      const Eigen::Vector2d center = slides_ ? Eigen::Vector2d(post_ - value * Eigen::Vector2d::UnitX())
                                             : Eigen::Vector2d(Eigen::Rotation2Dd(-value) * post_);
      const Eigen::Array2d beyond =
          ((center - Eigen::Vector2d(0.4, 0.0)).array().abs() - Eigen::Array2d(0.1, 0.03)).max(0.0);
      least = std::min(least, beyond.matrix().norm() - 0.05);
    }
    return least;
  }

 private:
  bool slides_;
  double lower_, upper_;
  Eigen::Vector2d post_;
  UrdfRobot robot_;
};

}  // namespace clearway::worlds
