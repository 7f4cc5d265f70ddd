#include "planning/robot_files/srdf_file.hpp"

#include <gtest/gtest.h>

#include "planning/check/path_check.hpp"
#include "planning/robot/held_joints.hpp"
#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace srdf_file_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;
using Names = std::set<std::string>;

/// Two arms of two joints on a torso that turns, a gripper on the left one whose second finger mimics.
const std::string& two_arms() {
  static const std::string text = [] {
    std::string links = "<robot name='two'><link name='base'/>", shape = "<sphere radius='0.05'/>";
    for (const char* link : {"torso", "l1", "l2", "r1", "r2", "palm", "f1", "f2"})
      links += urdf_link(link, "0 0 0", shape);
    const std::string turn = urdf_limit(-2, 2);
    return links + urdf_joint("waist", "revolute", "base", "torso", "0 0 1", "0 0 1", turn) +
           urdf_joint("lj1", "revolute", "torso", "l1", "0 0.3 0", "0 0 1", turn) +
           urdf_joint("lj2", "revolute", "l1", "l2", "0.3 0 0", "0 0 1", turn) +
           urdf_joint("mount", "fixed", "l2", "palm", "0.3 0 0", "0 0 1", "") +
           urdf_joint("fj1", "prismatic", "palm", "f1", "0 0.1 0", "0 1 0", urdf_limit(0.01, 0.04)) +
           urdf_joint("fj2", "prismatic", "palm", "f2", "0 -0.1 0", "0 -1 0",
                      urdf_limit(0, 0.04) + "<mimic joint='fj1'/>") +
           urdf_joint("rj1", "revolute", "torso", "r1", "0 -0.3 0", "0 0 1", turn) +
           urdf_joint("rj2", "revolute", "r1", "r2", "0.3 0 0", "0 0 1", turn) + "</robot>";
  }();
  return text;
}

const std::string groups =
    "<group name='left'><chain base_link='torso' tip_link='palm'/></group>"
    "<group name='across'><chain base_link='l2' tip_link='r1'/></group>"
    "<group name='right'><joint name='rj1'/><joint name='rj2'/></group>"
    "<group name='links'><link name='r2'/><link name='palm'/><link name='torso'/></group>"
    "<group name='hand'><joint name='fj1'/><joint name='fj2'/><joint name='mount'/></group>"
    "<group name='all'><group name='left'/><group name='right'/><group name='all'/></group>"
    "<virtual_joint name='world' type='fixed' parent_frame='w' child_link='base'/>"
    "<virtual_joint name='wheels' type='planar' parent_frame='w' child_link='base'/>"
    "<group name='stands'><joint name='world'/><group name='right'/></group>"
    "<group name='rolls'><joint name='wheels'/><group name='right'/></group>"
    "<group name='passive'><passive_joint name='rj1'/><joint name='rj2'/></group>"
    "<group name='empty'><joint name='mount'/></group>"
    "<group_state name='home' group='left'><joint name='lj1' value='0.5'/><joint name='lj2' value='-1'/>"
    "</group_state><group_state name='home' group='right'><joint name='rj1' value='0.1'/>"
    "<joint name='rj2' value='0.2'/><joint name='lj1' value='9'/></group_state>"
    "<group_state name='default' group='hand'><joint name='fj1' value='0.03'/></group_state>"
    "<end_effector name='gripper' parent_link='l2' group='hand' parent_group='left'/>"
    "<disable_collisions link1='l1' link2='r1' reason='Never'/>"
    "<disable_collisions link1='l1' link2='a_camera' reason='Never'/>";

class SrdfFile : public ::testing::Test {
 protected:
  void SetUp() override {
    urdf_ = folder_.write("two.urdf", two_arms());
    srdf_ = folder_.write("two.srdf", "<robot name='two'>" + groups + "</robot>");
  }

  Robot robot(const std::string& group, const std::map<std::string, double>& fixed = {}) const {
    return load_robot(RobotRequest{urdf_, {}, group, fixed});
  }

  Names joints(const std::string& group) const {
    Names names;
    for (const Joint& joint : robot(group).joints) names.insert(joint.name);
    return names;
  }

  std::string refusal(const RobotRequest& request) const { return folder_.refusal(request); }

  RobotFolder folder_;
  std::string urdf_, srdf_;
};

TEST_F(SrdfFile, AGroupIsItsChainsJointsLinksAndSubgroupsLessWhatIsFixedOrFollows) {
  EXPECT_EQ(joints("left"), (Names{"lj1", "lj2"}));
  EXPECT_EQ(joints("across"), (Names{"lj1", "lj2", "rj1"}));
  EXPECT_EQ(joints("right"), (Names{"rj1", "rj2"}));
  EXPECT_EQ(joints("links"), (Names{"rj2", "waist"}));
  EXPECT_EQ(joints("hand"), (Names{"fj1"}));
  EXPECT_EQ(joints("all"), (Names{"lj1", "lj2", "rj1", "rj2"}));
  EXPECT_EQ(joints("stands"), (Names{"rj1", "rj2"}));
  EXPECT_EQ(joints("passive"), (Names{"rj1", "rj2"}));
  EXPECT_EQ(joints(""), (Names{"waist", "lj1", "lj2", "fj1", "rj1", "rj2"}));
}

TEST_F(SrdfFile, OfAnotherRobotIsToldByItsNameAndByTheLinksOfItsPairs) {
  EXPECT_EQ(srdf_notes(robot("")),
            (std::vector<std::string>{"the SRDF '" + srdf_ +
                                      "' names 1 link in pairs without a test that the "
                                      "robot does not have: a_camera"}));
  const std::string other = folder_.write(
      "other.srdf",
      "<robot name='three'><disable_collisions link1='l1' link2='r3'/>"
      "<disable_default_collisions link='r4'/><enable_collisions link1='r5' link2='r3'/></robot>");
  EXPECT_EQ(srdf_notes(load_robot(RobotRequest{urdf_, other})),
            (std::vector<std::string>{
                "the SRDF '" + other + "' is for robot 'three', the URDF's robot is called 'two'",
                "the SRDF '" + other +
                    "' names 3 links in pairs without a test that the robot does not have: r3, r4, r5"}));
  const std::string own = folder_.write(
      "own.srdf", "<robot name='two'><disable_collisions link1='l1' link2='r1' reason='Never'/></robot>");
  EXPECT_TRUE(srdf_notes(load_robot(RobotRequest{urdf_, own})).empty());
  const std::string no_group = folder_.write(
      "state.srdf",
      "<robot name='two'><group_state name='home'><joint name='lj1' value='0.5'/></group_state></robot>");
  EXPECT_EQ(srdf_notes(load_robot(RobotRequest{urdf_, no_group})),
            (std::vector<std::string>{"the SRDF '" + no_group +
                                      "' is read without its states that name no group: home"}));
  const std::string several =
      folder_.write("several.srdf",
                    "<robot name='two'><group name='left'><joint name='lj1'/></group>"
                    "<virtual_joint name='world' type='floating' parent_frame='w' child_link='base'/>"
                    "<group_state name='home' group='left'><joint name='lj1' value='0.5 0.6'/>"
                    "<joint name='world' value='0 0 0 0 0 0 1'/></group_state></robot>");
  EXPECT_EQ(srdf_notes(load_robot(RobotRequest{urdf_, several})),
            (std::vector<std::string>{"the SRDF '" + several +
                                      "' is read without what state 'home' says of joint 'lj1': several "
                                      "values, expected one"}));
  EXPECT_TRUE(srdf_notes(load_robot("planar2")).empty()) << "without a SRDF";
}

TEST_F(SrdfFile, TheCheckFindsTheSameJointsInEveryGroupAndRefusesOthers) {
  for (const char* group : {"left", "across", "right", "links", "hand", "all", "stands", "passive"}) {
    Robot arm = robot(group);
    Configuration q(static_cast<Eigen::Index>(arm.dof()));
    for (std::size_t j = 0; j < arm.dof(); ++j) q[static_cast<Eigen::Index>(j)] = arm.joints[j].lower;
    const std::string said = check_path(arm, Snapshot(), {}, 0.0, {q}).first_contact;
    EXPECT_EQ(said.find("is not what its file"), std::string::npos) << said;
    arm.group = std::string(group) == "right" ? "left" : "right";
    if (joints(group) == joints(arm.group)) continue;
    const std::string lie = check_path(arm, Snapshot(), {}, 0.0, {q}).first_contact;
    EXPECT_NE(lie.find("is not what its file"), std::string::npos) << group;
  }
}

TEST_F(SrdfFile, PassiveJointsAreNotPlannedWhateverGroupHasThem) {
  const std::string srdf =
      folder_.write("idle.srdf", "<robot name='two'>" + groups + "<passive_joint name='rj1'/></robot>");
  for (const auto& [group, expected] :
       {std::pair("right", Names{"rj2"}), std::pair("across", Names{"lj1", "lj2"}),
        std::pair("all", Names{"lj1", "lj2", "rj2"}), std::pair("passive", Names{"rj2"})}) {
    const Robot robot = load_robot(RobotRequest{urdf_, srdf, group});
    Names found;
    for (const Joint& joint : robot.joints) found.insert(joint.name);
    EXPECT_EQ(found, expected) << group;
    EXPECT_EQ(file_disagreement(robot), "") << group;
  }
}

TEST_F(SrdfFile, JointsOutsideStandWhereTheyAreFixedElseByTheDefaultStateElseAtZeroInLimits) {
  const auto held = [](const Robot& robot) {
    std::map<std::string, double> values;
    for (const HeldJoint& joint : robot.held) values[joint.name] = joint.value;
    return values;
  };
  using Values = std::map<std::string, double>;
  EXPECT_EQ(held(robot("left")), (Values{{"fj1", 0.03}, {"rj1", 0}, {"rj2", 0}, {"waist", 0}}));
  EXPECT_EQ(held(robot("left", {{"waist", 0.5}, {"fj1", 0.02}})),
            (Values{{"fj1", 0.02}, {"rj1", 0}, {"rj2", 0}, {"waist", 0.5}}));
  EXPECT_EQ(held(robot("", {{"waist", 0.5}})), (Values{{"waist", 0.5}}));
  folder_.write("two.yaml", "group: right\nfixed: {lj1: 0.7, waist: -0.2}\n");
  EXPECT_EQ(held(robot("", {{"waist", 0.5}})),
            (Values{{"fj1", 0.03}, {"lj1", 0.7}, {"lj2", 0}, {"waist", 0.5}}));
  folder_.write("two.srdf", "<robot name='two'><group name='right'><link name='r2'/></group></robot>");
  EXPECT_EQ(held(robot("")).at("fj1"), 0.01);  // its lower limit is above 0
}

TEST_F(SrdfFile, StatesTipsAndPairsAreRead) {
  const Robot left = robot("left"), right = robot("right");
  EXPECT_EQ(left.links[static_cast<std::size_t>(left.tip_link)].name, "l2");    // of its end effector
  EXPECT_EQ(right.links[static_cast<std::size_t>(right.tip_link)].name, "r2");  // the last that moves
  ASSERT_EQ(left.states.size(), 2U);
  const NamedState& home = left.states[1];
  EXPECT_EQ(home.name, "home");
  EXPECT_EQ(home.values,
            (std::map<std::string, double>{{"lj1", 0.5}, {"lj2", -1}, {"rj1", 0.1}, {"rj2", 0.2}}));
  EXPECT_EQ(right.states[1].values.at("lj1"), 9.0);  // what the planning group's own state says counts first
  const auto body = [&](const std::string& part) {
    for (std::size_t i = 0; i < left.bodies.size(); ++i)
      if (left.bodies[i].part == part) return static_cast<int>(i);
    return -1;
  };
  const std::pair<int, int> pair = std::minmax({body("l1"), body("r1")});
  EXPECT_EQ(std::count(left.exempt.begin(), left.exempt.end(), pair), 1);
}

TEST_F(SrdfFile, ATipMayBeCalledByItsEndEffectorUnlessALinkHasThatName) {
  const Robot left = robot("left");
  EXPECT_EQ(link_of_tip(left, "gripper"), "l2");
  EXPECT_EQ(link_of_tip(left, "palm"), "palm");
  EXPECT_EQ(link_of_tip(left, "gripped"), "gripped");
  folder_.write("two.srdf",
                "<robot name='two'><end_effector name='palm' parent_link='l2' group='hand'/></robot>");
  EXPECT_EQ(link_of_tip(left, "palm"), "palm");
  Robot alone = left;
  alone.srdf.clear();
  EXPECT_EQ(link_of_tip(alone, "gripper"), "gripper");
}

TEST_F(SrdfFile, AStateThatLeavesJointsOpenIsRefusedWithTheRemedy) {
  const auto refused = [&](const Robot& robot) {
    try {
      named_configuration(robot, "home");
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      return text.substr(text.find(" says"));
    }
    return std::string("accepted");
  };
  EXPECT_EQ(
      refused(robot("", {{"waist", 0.0}})),
      " says nothing of joint 'fj1', expected a state of all joints, or --fix JOINT=VALUE for that joint");
  EXPECT_EQ(
      refused(robot("")),
      " says nothing of joints waist, fj1, expected a state of all joints, or --fix JOINT=VALUE for each "
      "of them");
  EXPECT_EQ(refused(robot("hand")),
            " says nothing of joint 'fj1', expected a state of the whole group 'hand', or --fix JOINT=VALUE "
            "for that joint");
}

TEST_F(SrdfFile, StatesOfOneNameThatContradictEachOtherAreTold) {
  const Robot all = robot("all", {{"waist", 0.0}});
  try {
    named_configuration(all, "home");
    ADD_FAILURE() << "left has lj1 at 0.5, right at 9";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "state 'home' of " + srdf_ +
                  ": groups 'left' and 'right' have joint 'lj1' at 0.5 and at 9, expected one of them, or a "
                  "state of group 'all'");
  }
  EXPECT_EQ(*named_configuration(robot("left"), "home"), Configuration(Eigen::Vector2d(0.5, -1.0)));
  EXPECT_EQ(*named_configuration(robot("right", {{"lj1", 0.0}}), "home"),
            Configuration(Eigen::Vector2d(0.1, 0.2)));
}

TEST_F(SrdfFile, JointsThatAStateLeavesOpenAreTakenFromElsewhere) {
  const Robot across = robot("across", {{"rj1", 0.3}}),
              links = robot("links", {{"lj1", 0.5}, {"lj2", -1.0}, {"rj1", 0.1}});
  EXPECT_TRUE(joints_left_open(across, "home").empty());
  EXPECT_TRUE(joints_left_open(links, "nowhere").empty());
  const std::vector<std::size_t> open = joints_left_open(links, "home");  // waist, rj2
  ASSERT_EQ(open, std::vector<std::size_t>{0});
  EXPECT_EQ(*named_configuration(links, "home", Eigen::Vector2d(0.7, 0.8)),
            Configuration(Eigen::Vector2d(0.7, 0.2)));
  EXPECT_THROW(named_configuration(links, "home"), std::invalid_argument);
}

TEST_F(SrdfFile, ALinkOffByDefaultMeetsOnlyWhatIsEnabledAgain) {
  const auto exempt = [&](const std::string& text) {
    const std::string srdf = folder_.write("pairs.srdf", "<robot name='two'>" + text + "</robot>");
    const Robot robot = load_robot(RobotRequest{urdf_, srdf});
    std::set<std::string> pairs;
    for (const auto& [a, b] : robot.exempt) {
      const auto part = [&](int body) { return robot.bodies[static_cast<std::size_t>(body)].part; };
      const auto [first, second] = std::minmax({part(a), part(b)});
      pairs.insert(first + " " + second);
    }
    return pairs;
  };
  const std::set<std::string> adjacent = exempt("<disable_collisions link1='a_camera' link2='l1'/>");
  const std::string off = "<disable_default_collisions link='r2'/>";
  const std::string l1_again = "<enable_collisions link1='r2' link2='l1' reason='needed'/>";
  std::set<std::string> expected = adjacent;
  for (const char* other : {"f1", "f2", "l1", "l2", "palm"}) expected.insert(std::string(other) + " r2");
  expected.insert("r2 torso");
  EXPECT_EQ(exempt(off), expected);
  expected.erase("l1 r2");
  EXPECT_EQ(exempt(off + l1_again), expected);
  EXPECT_EQ(exempt(l1_again + off), expected);
  expected.insert("l1 r2");
  EXPECT_EQ(exempt(off + l1_again + "<disable_collisions link1='l1' link2='r2'/>"), expected);
  EXPECT_EQ(exempt("<disable_default_collisions link='a_camera'/>" + l1_again), adjacent);
  std::set<std::string> fewer = adjacent;  // neighbours, too
  EXPECT_EQ(fewer.erase("r1 r2"), 1U);
  const std::string neighbours =
      "<disable_collisions link1='a_camera' link2='l1'/>"
      "<enable_collisions link1=' r2' link2='r1 '/>";
  EXPECT_EQ(exempt(neighbours), fewer);
  EXPECT_EQ(exempt(neighbours + "<disable_collisions link1='r1' link2='r2'/>"), adjacent);
}

/// As MoveIt's assistant writes what stands at a limit of pi.
TEST_F(SrdfFile, AStateThatFourDigitsRoundBeyondALimitIsAtTheLimit) {
  std::string text = two_arms();
  const std::string limit = urdf_limit(-2, 2), pi = urdf_limit(-3.14159, 3.14159);
  for (std::size_t at; (at = text.find(limit)) != std::string::npos;) text.replace(at, limit.size(), pi);
  folder_.write("two.urdf", text);
  const auto at = [&](const std::string& value) {
    folder_.write("two.srdf",
                  "<robot name='two'><group name='right'><joint name='rj1'/></group><group_state name='up' "
                  "group='right'>"
                  "<joint name='rj1' value='" +
                      value +
                      "'/></group_state><group_state name='default' group='left'><joint name='lj1' value='" +
                      value + "'/></group_state></robot>");
    return *named_configuration(robot("right"), "up");
  };
  EXPECT_EQ(at("3.1416")[0], 3.14159);
  EXPECT_EQ(at("-3.1416")[0], -3.14159);
  EXPECT_EQ(at("3.1415")[0], 3.1415);
  const Robot right = robot("right");
  const auto lj1 = std::find_if(right.held.begin(), right.held.end(),
                                [](const HeldJoint& joint) { return joint.name == "lj1"; });
  ASSERT_NE(lj1, right.held.end());
  EXPECT_EQ(lj1->value, 3.1415);
  at("3.1416");
  EXPECT_EQ(robot("right").held[1].value, 3.14159);
  EXPECT_THROW(at("3.1418"), std::invalid_argument);
}

/// Two balls at one place, three links apart: a SRDF that says nothing of pairs leaves them exempt.
TEST_F(SrdfFile, WithoutPairsWhatAlwaysTouchesIsFoundAsWithoutSrdf) {
  std::string text = "<robot name='coil'>";
  for (const char* link : {"a", "b", "c", "d"}) text += urdf_link(link, "0 0 0", "<sphere radius='0.05'/>");
  for (const auto& [parent, child] : {std::pair("a", "b"), std::pair("b", "c"), std::pair("c", "d")})
    text += urdf_joint(child, "revolute", parent, child, "0 0 0.01", "0 0 1", urdf_limit(-1, 1));
  const std::string urdf = folder_.write("coil.urdf", text + "</robot>");
  const auto pairs = [&](const std::string& inside) {
    const std::string srdf = folder_.write("c.srdf", "<robot name='coil'>" + inside + "</robot>");
    return load_robot(RobotRequest{urdf, srdf}).exempt.size();
  };
  const std::string group = "<group name='g'><chain base_link='a' tip_link='d'/></group>";
  EXPECT_EQ(load_robot(urdf).exempt.size(), 6U);
  EXPECT_EQ(pairs(group), 6U);
  EXPECT_EQ(pairs(group + "<disable_collisions link1='a' link2='c'/>"), 4U);
}

TEST_F(SrdfFile, ANumberOfPairsIsTheMost) {
  const auto of = [](int pairs) {
    std::string text = "<robot name='r'>";
    for (int i = 0; i < pairs; ++i) text += "<disable_collisions link1='a' link2='b'/>";
    return text + "</robot>";
  };
  EXPECT_EQ(read_srdf(folder_.write("most.srdf", of(100'000))).disabled.size(), 100'000U);
  EXPECT_THROW(read_srdf(folder_.write("more.srdf", of(100'001))), std::invalid_argument);
}

TEST_F(SrdfFile, WhatIsWrongIsReportedInOneSentence) {
  const auto asked = [&](const std::string& group) { return refusal(RobotRequest{urdf_, {}, group}); };
  EXPECT_EQ(asked("lefd"),
            "two.srdf: there is no group 'lefd', expected one of across, all, empty, hand, left, links, "
            "passive, right, "
            "rolls, stands");
  EXPECT_EQ(asked("empty"), "two.srdf: group 'empty' has no joint that moves");
  EXPECT_EQ(asked("rolls"),
            "two.srdf: group 'rolls' moves the base by virtual joint 'wheels' of type 'planar', expected a "
            "base that stands");
  const auto holding = [&](const std::string& text) {
    return refusal(
        RobotRequest{urdf_, folder_.write("other.srdf", "<robot name='two'>" + text + "</robot>"), "g"});
  };
  EXPECT_EQ(holding("<group name='g'><joint name='no'/></group>"),
            "other.srdf: group 'g' names joint 'no', which two does not have");
  EXPECT_EQ(holding("<group name='g'><chain base_link='base' tip_link='no'/></group>"),
            "other.srdf: group 'g' names link 'no', which two does not have");
  EXPECT_EQ(holding("<group name='g'><chain base_link='base'/></group>"),
            "other.srdf: <chain> needs tip_link=…");
  EXPECT_EQ(holding("<group name='g'><jiont name='lj1'/></group>"),
            "other.srdf: group 'g' holds <jiont>, expected link, joint, chain or group");
  EXPECT_EQ(holding("<grup name='g'/>"), "other.srdf: unknown element <grup>, did you mean <group>?");
  EXPECT_EQ(holding("<group name='g'/><group name='g'/>"), "other.srdf: group 'g' is defined twice");
  EXPECT_EQ(holding("<group_state name='s' group='g'><joint name='lj1' value='1e'/></group_state>"),
            "other.srdf: joint 'lj1' of state 's' has the value '1e', expected a finite number");
  EXPECT_EQ(holding("<group_state name='s' group='g'><joint name='lj1' value=' '/></group_state>"),
            "other.srdf: <joint> needs value=…");
  // What nobody asks for stops nobody.
  const std::string odd = folder_.write(
      "odd.srdf",
      "<robot name='two'><group name='g'/><group name='g'/><group name='h'><other/></group>"
      "<end_effector name='e' parent_link='base'/><virtual_joint name='v' child_link='base'/>"
      "<group_state name='s' group='g'><joint name='lj1' value=' 0.25 '/></group_state></robot>");
  EXPECT_EQ(refusal(RobotRequest{urdf_, odd}), "accepted");
  EXPECT_EQ(read_srdf(odd).states.front().values.at("lj1"), 0.25);
  folder_.write("two.srdf", "<robot");
  EXPECT_EQ(asked("left"), "two.srdf: is not a SRDF, expected XML with a <robot> element");
  std::filesystem::remove(srdf_);
  EXPECT_EQ(asked("left"),
            "group 'left' of robot 'two': expected a SRDF that defines it, by --srdf or beside the URDF");
}

/// A joint that follows another is where that one takes it: a state that names it alone would be lost.
TEST_F(SrdfFile, AStateOfFixMayNameAFollowerOnlyWhereItsMasterTakesIt) {
  const std::string wide = worlds::urdf_limit(-2, 2), ball = "<sphere radius='0.05'/>";
  const std::string arm = folder_.write(
      "hand.urdf", "<robot name='hand'><link name='base'/>" + worlds::urdf_link("upper", "0.2 0 0", ball) +
                       worlds::urdf_link("thumb", "0.1 0 0", ball) +
                       worlds::urdf_link("finger", "0.1 0 0", ball) +
                       worlds::urdf_joint("turn", "revolute", "base", "upper", "0 0 0", "0 0 1", wide) +
                       worlds::urdf_joint("m", "revolute", "upper", "thumb", "0.4 0 0", "0 0 1", wide) +
                       worlds::urdf_joint("m2", "revolute", "upper", "finger", "0.4 0.3 0", "0 0 -1",
                                          wide + "<mimic joint='m' multiplier='-1.5' offset='0.2'/>") +
                       "</robot>");
  const auto told = [&](const std::string& values) {
    folder_.write("hand.srdf",
                  "<robot name='hand'><group name='arm'><joint name='turn'/></group><group name='grip'>"
                  "<joint name='m'/></group><group_state name='open' group='grip'>" +
                      values + "</group_state></robot>");
    return refusal(RobotRequest{.robot = arm, .group = "arm", .fixed_states = {"open"}});
  };
  const std::string m = "<joint name='m' value='0.4'/>";
  EXPECT_EQ(told(m), "accepted");
  EXPECT_EQ(told(m + "<joint name='m2' value='-0.4'/>"), "accepted");
  EXPECT_EQ(told("<joint name='m2' value='-0.4'/>"),
            "--fix: state 'open' of group 'grip' has joint 'm2' at -0.4, which follows joint 'm', and not "
            "that one; "
            "expected its value");
  EXPECT_EQ(told(m + "<joint name='m2' value='0.3'/>"),
            "--fix: state 'open' of group 'grip' has joint 'm2' at 0.3, which follows joint 'm', by which it "
            "would be "
            "elsewhere; expected values that agree");
}

}  // namespace srdf_file_test
}  // namespace clearway
