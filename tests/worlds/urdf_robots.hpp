#pragma once

// Small robots that no shipped one stands for, as files: what a factor, a sign or a limit does to a bound
// shows in them and not in arms whose every joint turns one link by its own angle.

#include <string>

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

/// Two arms beside each other on one base, which meet between them; siblings, each with a joint of its own.
inline UrdfRobot scissors() {
  const std::string blade = "<capsule radius='0.03' length='0.6'/>";
  return {
      "scissors",
      "<link name='base'/>" + urdf_link("left", "0.35 0 0", blade) + urdf_link("right", "-0.35 0 0", blade) +
          urdf_joint("left_turn", "revolute", "base", "left", "-0.5 0 0", "0 0 1", urdf_limit(-1.5, 1.5)) +
          urdf_joint("right_turn", "revolute", "base", "right", "0.5 0 0", "0 0 1", urdf_limit(-1.5, 1.5))};
}

}  // namespace clearway::worlds
