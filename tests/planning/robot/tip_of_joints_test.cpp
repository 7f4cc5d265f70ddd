#include "planning/robot/tip_of_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace clearway {
namespace tip_of_joints_test {

/// A robot's tree of links, the first of which is "base".
class Tree {
 public:
  Tree() { robot_.links.push_back({.name = "base"}); }

  Tree& fixed(const std::string& parent, const std::string& link) { return add(parent, link, -1); }
  Tree& turns(const std::string& parent, const std::string& link) {
    return moves(parent, link, {.name = link + "_joint", .lower = -3.0, .upper = 3.0});
  }
  Tree& slides(const std::string& parent, const std::string& link, double travel = 0.04) {
    return moves(parent, link,
                 {link + "_joint", JointKind::prismatic, Eigen::Vector3d::UnitX(), 0.0, travel});
  }
  Tree& mimics(const std::string& parent, const std::string& link, const std::string& joint) {
    const auto found = std::find_if(robot_.joints.begin(), robot_.joints.end(),
                                    [&](const Joint& known) { return known.name == joint; });
    return add(parent, link, static_cast<int>(found - robot_.joints.begin()));
  }
  Tree& called(const std::string& joint) {  // the last one
    robot_.links.back().joint_name = robot_.joints.back().name = joint;
    return *this;
  }
  /// base or parent, then name1, name2, …
  Tree& chain(const std::string& parent, const std::string& name, int joints) {
    for (int i = 1; i <= joints; ++i)
      turns(i == 1 ? parent : name + std::to_string(i - 1), name + std::to_string(i));
    return *this;
  }

  /// The tip's link, others behind it after a slash each.
  std::string tip(const std::set<std::string>& held = {}) const {
    Robot robot = robot_;
    std::erase_if(robot.joints, [&](const Joint& joint) { return held.contains(joint.name); });
    const TipOfJoints found = tip_of_joints(robot_, {}, robot);
    std::string names = name(found.link);
    for (const int other : found.others) names += "/" + name(other);
    return names;
  }
  std::string finger_joint() const { return tip_of_joints(robot_, {}, robot_).finger_joint; }

 private:
  std::string name(int link) const { return robot_.links[static_cast<std::size_t>(link)].name; }

  Tree& moves(const std::string& parent, const std::string& link, const Joint& joint) {
    robot_.joints.push_back(joint);
    return add(parent, link, static_cast<int>(robot_.joints.size()) - 1);
  }
  Tree& add(const std::string& parent, const std::string& link, int joint) {
    const auto above = std::find_if(robot_.links.begin(), robot_.links.end(),
                                    [&](const Link& known) { return known.name == parent; });
    Link added{.name = link, .parent = static_cast<int>(above - robot_.links.begin()), .joint = joint};
    added.parent_from_link.translation().z() = 0.1;
    added.joint_name = link + "_joint";
    robot_.links.push_back(added);
    return *this;
  }

  Robot robot_;
};

/// ur_description, new and old: a flange and tool0, or tool0 and ee_link side by side.
TEST(TipOfJoints, OfUniversalRobotsIsTheToolFrame) {
  Tree ur = Tree().chain("base", "wrist_", 6);
  EXPECT_EQ(ur.tip(), "wrist_6");
  Tree old = ur;
  EXPECT_EQ(ur.fixed("wrist_6", "ft_frame").fixed("wrist_6", "flange").fixed("flange", "tool0").tip(),
            "tool0");
  EXPECT_EQ(old.fixed("wrist_6", "ee_link").fixed("wrist_6", "tool0").tip(), "tool0");
}

TEST(TipOfJoints, OfAnArmWithACameraIsNotTheCamera) {
  Tree ur = Tree().chain("base", "link_", 6).fixed("link_6", "tool0").fixed("tool0", "camera_link");
  ur.fixed("camera_link", "camera_color_frame").fixed("camera_color_frame", "camera_color_optical_frame");
  EXPECT_EQ(ur.tip(), "tool0");
  Tree bare = Tree().chain("base", "link_", 6).fixed("link_6", "realsense_mount");
  EXPECT_EQ(bare.fixed("realsense_mount", "lens").tip(), "link_6");
}

/// franka_description: the hand's tcp in newer ones, the hand in older ones; the fingers are one joint.
TEST(TipOfJoints, OfAPandaIsItsHandOrTheHandsTcp) {
  Tree panda = Tree().chain("base", "panda_link", 7).fixed("panda_link7", "panda_link8");
  panda.fixed("panda_link8", "panda_hand").slides("panda_hand", "panda_leftfinger");
  Tree two = panda;
  panda.mimics("panda_hand", "panda_rightfinger", "panda_leftfinger_joint");
  EXPECT_EQ(panda.tip(), "panda_hand");
  EXPECT_EQ(panda.fixed("panda_hand", "panda_hand_tcp").tip(), "panda_hand_tcp");
  EXPECT_EQ(two.slides("panda_hand", "panda_rightfinger").tip(), "panda_hand");
  EXPECT_EQ(two.finger_joint(), "");
}

TEST(TipOfJoints, OfAnIiwaWithTwoFingersIsTheGripper) {
  Tree iiwa = Tree().chain("base", "iiwa_link_", 7).fixed("iiwa_link_7", "iiwa_link_ee");
  EXPECT_EQ(iiwa.tip(), "iiwa_link_ee");
  iiwa.fixed("iiwa_link_ee", "wsg_base").slides("wsg_base", "wsg_left").slides("wsg_base", "wsg_right");
  iiwa.fixed("wsg_left", "wsg_left_pad").fixed("wsg_right", "wsg_right_pad");
  EXPECT_EQ(iiwa.tip(), "iiwa_link_ee");
  EXPECT_EQ(iiwa.fixed("wsg_base", "gripper_center").tip(), "gripper_center");
}

/// Robotiq's 2F-85 on Kinova's Gen3, whose bracelet has cameras beside the tool frame.
TEST(TipOfJoints, OfAGen3WithRobotiqIsItsToolFrame) {
  Tree gen3 = Tree().chain("base", "half_", 7).fixed("half_7", "end_effector_link");
  gen3.fixed("end_effector_link", "camera_link").fixed("camera_link", "camera_depth_frame");
  gen3.fixed("end_effector_link", "robotiq_85_base_link");
  gen3.turns("robotiq_85_base_link", "left_knuckle").fixed("left_knuckle", "left_finger");
  const std::string drive = "left_knuckle_joint";
  gen3.mimics("robotiq_85_base_link", "right_knuckle", drive).fixed("right_knuckle", "right_finger");
  gen3.mimics("robotiq_85_base_link", "left_inner_knuckle", drive);
  gen3.mimics("robotiq_85_base_link", "right_inner_knuckle", drive);
  gen3.mimics("left_finger", "left_finger_tip", drive).mimics("right_finger", "right_finger_tip", drive);
  EXPECT_EQ(gen3.tip(), "end_effector_link");
  EXPECT_EQ(gen3.fixed("end_effector_link", "tool_frame").tip(), "tool_frame");
}

TEST(TipOfJoints, OfAnXArmWithItsGripperIsItsTcp) {
  Tree xarm = Tree().chain("base", "link", 6).fixed("link6", "link_eef");
  xarm.fixed("link_eef", "xarm_gripper_base_link").turns("xarm_gripper_base_link", "left_outer_knuckle");
  xarm.called("drive_joint").mimics("left_outer_knuckle", "left_finger", "drive_joint");
  for (const char* link : {"left_inner_knuckle", "right_outer_knuckle", "right_inner_knuckle"})
    xarm.mimics("xarm_gripper_base_link", link, "drive_joint");
  xarm.mimics("right_outer_knuckle", "right_finger", "drive_joint");
  EXPECT_EQ(xarm.tip(), "link_eef");
  EXPECT_EQ(xarm.fixed("xarm_gripper_base_link", "link_tcp").tip(), "link_tcp");
}

/// Fetch: wheels, a torso, a head of two joints, an arm of seven and two fingers.
TEST(TipOfJoints, OfAMobileManipulatorIsTheArms) {
  Tree fetch = Tree().turns("base", "l_wheel").turns("base", "r_wheel").slides("base", "torso", 0.4);
  fetch.turns("torso", "head_pan").turns("head_pan", "head_tilt").fixed("head_tilt", "head_camera_link");
  fetch.chain("torso", "arm", 7).fixed("arm7", "gripper_link");
  fetch.slides("gripper_link", "r_gripper_finger").slides("gripper_link", "l_gripper_finger");
  EXPECT_EQ(fetch.tip(), "gripper_link");
}

TEST(TipOfJoints, OfSeveralArmsNamesAllOfThem) {
  Tree pr2 = Tree().slides("base", "torso", 0.4).turns("torso", "pan").turns("pan", "tilt");
  for (const std::string side : {"l", "r"}) {
    const std::string last = side + "_7", palm = side + "_palm";
    pr2.chain("torso", side + "_", 7).fixed(last, palm).fixed(palm, side + "_tool_frame");
    pr2.turns(palm, side + "_a_finger").turns(palm, side + "_b_finger");
  }
  EXPECT_EQ(pr2.tip(), "l_tool_frame/r_tool_frame");
  std::set<std::string> held;  // one arm stands still
  for (int i = 1; i <= 7; ++i) held.insert("l_" + std::to_string(i) + "_joint");
  EXPECT_EQ(pr2.tip(held), "r_tool_frame");
  EXPECT_EQ(Tree().chain("base", "long", 7).chain("base", "leg", 4).tip(), "long7");
  EXPECT_EQ(Tree().chain("base", "leg", 5).chain("base", "long", 7).tip(), "long7/leg5");
  Tree torso = Tree().turns("base", "torso").chain("torso", "l", 4).chain("torso", "r", 4);
  EXPECT_EQ(torso.tip(), "l4/r4");
  torso.fixed("l4", "l_hand").fixed("r4", "r_hand");
  EXPECT_EQ(torso.tip(), "l_hand/r_hand");
}

/// What branches, and is neither a hand nor an arm.
TEST(TipOfJoints, OfBranchesThatNothingCallsAGripperIsTheEndOfTheLongest) {
  Tree arm = Tree().chain("base", "j", 6).fixed("j6", "tool0");
  for (const char* link : {"j3", "j4", "j5"}) {
    Tree tilted = arm;
    EXPECT_EQ(tilted.turns(link, "tilt").fixed("tilt", "camera").tip(), "tool0") << link;
    EXPECT_EQ(tilted.turns("tilt", "pan").tip(), "tool0") << link;
  }
  Tree palletizer = Tree().chain("base", "j", 3).fixed("j3", "wrist").fixed("wrist", "suction_cup");
  palletizer.mimics("j1", "crank", "j2_joint").mimics("crank", "rod", "j3_joint");
  EXPECT_EQ(palletizer.tip(), "suction_cup");
  Tree lever = Tree().chain("base", "turret", 1).turns("turret1", "boom").turns("boom", "stick");
  EXPECT_EQ(
      lever.fixed("stick", "bucket").turns("turret1", "cylinder").slides("cylinder", "piston", 1.0).tip(),
      "bucket");
  Tree gantry = Tree().slides("base", "x", 1.0).slides("x", "y", 1.0).slides("y", "z", 0.1);
  gantry.fixed("z", "spindle").slides("y", "camera_z", 0.08).fixed("camera_z", "camera");
  EXPECT_EQ(gantry.tip(), "spindle");
  Tree mobile = Tree().chain("base", "arm", 3);
  for (const std::string wheel : {"a", "b", "c", "d"})
    mobile.turns("base", "steer_" + wheel).turns("steer_" + wheel, "wheel_" + wheel);
  EXPECT_EQ(mobile.tip(), "arm3") << "no wheel is an arm that could be meant";
}

/// Words for cameras and fingers are in names of tools, too.
TEST(TipOfJoints, OfFramesInARowIsTheLastUnlessThatIsACameraOrAFinger) {
  const auto arm = [] { return Tree().chain("base", "j", 6).fixed("j6", "flange"); };
  EXPECT_EQ(arm().fixed("flange", "laser_head").fixed("laser_head", "tcp").tip(), "tcp");
  EXPECT_EQ(arm()
                .fixed("flange", "camera_bracket")
                .fixed("camera_bracket", "gripper_base")
                .fixed("gripper_base", "gripper_tcp")
                .tip(),
            "gripper_tcp");
  EXPECT_EQ(arm().fixed("flange", "adapter").fixed("adapter", "two_finger_gripper_tcp").tip(),
            "two_finger_gripper_tcp");
  EXPECT_EQ(arm()
                .fixed("flange", "tool_changer")
                .fixed("tool_changer", "torch_body")
                .fixed("torch_body", "torch_tip")
                .tip(),
            "torch_tip");
}

/// A joint that is held, between arm and hand or of the fingers, moves no link and changes no tip.
TEST(TipOfJoints, IsNotMovedByJointsThatAreHeld) {
  Tree arm = Tree().chain("base", "j", 6).fixed("j6", "palm").slides("palm", "a").slides("palm", "b");
  for (const std::set<std::string>& held :
       std::vector<std::set<std::string>>{{},
                                          {"j6_joint"},
                                          {"a_joint"},
                                          {"a_joint", "b_joint"},
                                          {"j1_joint"},
                                          {"j5_joint", "j6_joint", "a_joint", "b_joint"}})
    EXPECT_EQ(arm.tip(held), "palm") << held.size();
}

TEST(TipOfJoints, OfASingleFingerIsTheLinkThatCarriesIt) {
  EXPECT_EQ(Tree().chain("base", "j", 5).turns("j5", "moving_jaw").tip(), "j5");
  EXPECT_EQ(Tree().chain("base", "j", 5).turns("j5", "part").called("gripper").tip(), "j5");
  EXPECT_EQ(Tree().chain("base", "j", 5).turns("j5", "part").called("gripper_roll_joint").tip(), "part");
  EXPECT_EQ(Tree().chain("base", "j", 4).fixed("j4", "gripper_frame").turns("j4", "part").tip(),
            "gripper_frame");
  EXPECT_EQ(Tree().chain("base", "j", 4).fixed("j4", "flange").turns("j4", "part").tip(), "part");
  EXPECT_EQ(Tree().chain("base", "claw_j", 5).turns("claw_j5", "claw_part").tip(), "claw_part")
      << "the robot's own name";
}

/// A lone short slide is a gripper's where it is called so; it may be the axis of a tool.
TEST(TipOfJoints, OfASingleSlideDependsOnTheJointsBefore) {
  Tree arm = Tree().chain("base", "j", 5).slides("j5", "part");
  EXPECT_EQ(arm.tip(), "part") << "nothing calls it a finger";
  EXPECT_EQ(Tree().chain("base", "j", 5).slides("j5", "left_finger").tip(), "j5");
  EXPECT_EQ(Tree().chain("base", "j", 5).slides("j5", "part", 0.2).tip(), "part");
  Tree scara = Tree().chain("base", "j", 3).slides("j3", "quill");
  EXPECT_EQ(scara.tip(), "quill");
  EXPECT_EQ(scara.finger_joint(), "");
}

TEST(TipOfJoints, OfNoArmIsTheRoot) { EXPECT_EQ(Tree().fixed("base", "tool0").tip(), "base"); }

/// Only some joints are asked for, as of a planning group; behind one that is not, links do not count.
TEST(TipOfJoints, OfSomeJointsIsBeforeTheOthers) {
  Robot robot;
  robot.links.push_back({.name = "base"});
  for (int i = 0; i < 3; ++i) {
    robot.joints.push_back({.name = "j" + std::to_string(i)});
    robot.links.push_back({.name = "l" + std::to_string(i), .parent = i, .joint = i});
  }
  EXPECT_EQ(tip_of_joints(robot, {"j0", "j1"}, robot).link, 2);
  EXPECT_EQ(tip_of_joints(robot, {"j1"}, robot).link, 2);
  EXPECT_EQ(tip_of_joints(robot, {}, robot).link, 3);
}

TEST(TipOfJoints, KnowsFramesByTheWordsOfTheirNames) {
  for (const char* name :
       {"tool0", "TCP", "panda_hand_tcp", "ee_link", "iiwa_link_ee", "link_eef", "flange", "EndEffector",
        "end_effector_link", "grasp_frame", "gripperCenter", "tool_center_point"})
    EXPECT_TRUE(is_tool_frame(name)) << name;
  for (const char* name : {"link6", "knee_link", "screen", "toolbox", "hand", "wrist_3_link"})
    EXPECT_FALSE(is_tool_frame(name)) << name;
  for (const char* name : {"camera_link", "LeftCamera", "panda_leftfinger", "imu", "moving_jaw"})
    EXPECT_TRUE(is_beside_tool(name)) << name;
  EXPECT_FALSE(is_beside_tool("simulated_palm"));
}

}  // namespace tip_of_joints_test
}  // namespace clearway
