#include "planning/robot_files/tip_choice.hpp"

#include <gtest/gtest.h>

#include "planning/robot/goal_configurations.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace tip_choice_test {

using worlds::urdf_joint;
using worlds::urdf_limit;

/// A carriage with a palm; what hangs on it is each test's own.
std::string hand(const std::string& more) {
  return "<robot name='hand'><link name='rail'/>" +
         worlds::urdf_link("palm", "0 0 0", "<sphere radius='0.05'/>") +
         urdf_joint("slide", "prismatic", "rail", "palm", "0 0 0", "1 0 0", urdf_limit(-1, 1)) + more +
         "</robot>";
}
std::string finger(const std::string& name) {
  return "<link name='" + name + "'/>" +
         urdf_joint(name + "_joint", "prismatic", "palm", name, "0 0 0", "0 1 0", urdf_limit(0, 0.1));
}
std::string fixed(const std::string& parent, const std::string& name) {
  return "<link name='" + name + "'/>" +
         urdf_joint(name + "_joint", "fixed", parent, name, "0 0 0", "1 0 0", "");
}

std::string doubt(const std::string& urdf, const std::string& settings = "", const std::string& srdf = "",
                  const std::string& group = "") {
  TemporaryFolder folder;
  RobotRequest request{folder.write("hand.urdf", urdf)};
  if (!settings.empty()) folder.write("hand.yaml", settings);
  if (!srdf.empty()) folder.write("hand.srdf", "<robot name='hand'>" + srdf + "</robot>");
  request.group = group;
  return tip_doubt(load_robot(request));
}

std::string tip_of(const std::string& urdf, const std::string& srdf, const std::string& group) {
  TemporaryFolder folder;
  RobotRequest request{folder.write("hand.urdf", urdf)};
  folder.write("hand.srdf", "<robot name='hand'>" + srdf + "</robot>");
  request.group = group;
  return tip_name(load_robot(request));
}

const std::string slide_group = "<group name='arm'><joint name='slide'/></group>";
const std::string fingers_group =
    "<group name='fingers'><link name='left'/><joint name='right_joint'/></group>"
    "<group name='both'><group name='arm'/><group name='fingers'/></group>";

TEST(TipChoice, OfAGroupIsWhatAnEndEffectorHangsOnThatIsAtItsEnd) {
  const std::string effector = "<end_effector name='gripper' parent_link='palm' group='fingers'/>";
  for (const bool is_held : {true, false}) {
    const std::string fingers =
        is_held ? finger("left") + finger("right") : fixed("palm", "left") + fixed("palm", "right");
    EXPECT_EQ(tip_of(hand(fingers), slide_group + fingers_group + effector, "arm"), "palm");
    EXPECT_EQ(doubt(hand(fingers), "", slide_group + fingers_group + effector, "arm"), "");
  }
  const std::string moving = hand(finger("left") + finger("right"));
  EXPECT_EQ(tip_of(moving, slide_group + fingers_group + effector, "both"), "palm");
  EXPECT_EQ(tip_of(moving, slide_group + fingers_group + effector, "fingers"), "left") << "its own group";
}

TEST(TipChoice, OfAGroupIsNotWhereAnEndEffectorHangsBeforeItsEnd) {
  const std::string longer = hand(fixed("palm", "camera") + finger("boom"));
  const std::string groups =
      "<group name='arm'><joint name='slide'/><joint name='boom_joint'/></group>"
      "<group name='look'><link name='camera'/></group>";
  for (const char* parent : {"palm", "rail", "nowhere"})
    EXPECT_EQ(
        tip_of(longer, groups + "<end_effector name='e' parent_link='" + parent + "' group='look'/>", "arm"),
        "boom")
        << parent;
}

TEST(TipChoice, OfAGroupWithAGapIsBelowItsLastJoint) {
  const std::string wrist = "<link name='tool'/>" + urdf_joint("wrist", "revolute", "left", "tool", "0 0 0",
                                                               "0 0 1", urdf_limit(-1, 1));
  const std::string groups = "<group name='arm'><joint name='wrist'/><joint name='slide'/></group>";
  EXPECT_EQ(tip_of(hand(finger("left") + wrist), groups, "arm"), "tool");
}

/// A note says that the first of several end effectors is the tip; where a chain says it there is none.
TEST(TipChoice, OfAChainIsNoQuestionWhateverHangsOnIt) {
  const std::string urdf = hand(fixed("palm", "flange") + fixed("flange", "camera"));
  const std::string effectors =
      "<group name='look'><link name='camera'/></group><group name='hold'><link name='flange'/></group>"
      "<end_effector name='eye' parent_link='flange' group='look'/>"
      "<end_effector name='gripper' parent_link='palm' group='hold'/>";
  const auto note_of = [&](const std::string& group) {
    TemporaryFolder folder;
    RobotRequest request{folder.write("hand.urdf", urdf)};
    folder.write("hand.srdf", "<robot name='hand'>" + group + effectors + "</robot>");
    request.group = "arm";
    std::string notes;
    for (const std::string& note : robot_notes(load_robot(request))) notes += note;
    return notes;
  };
  EXPECT_EQ(note_of("<group name='arm'><chain base_link='rail' tip_link='palm'/></group>"), "");
  EXPECT_NE(note_of(slide_group)
                .find("the first is the tip; --tip chooses another: 'eye' on link 'flange', "
                      "'gripper' on link 'palm'"),
            std::string::npos)
      << note_of(slide_group);
}

TEST(TipChoice, OfAGroupIsNoFinger) {
  const std::string tcp = fixed("palm", "tcp");
  const std::string pads = fixed("left", "pad") + fixed("right", "other_pad");
  EXPECT_EQ(tip_of(hand(finger("left") + finger("right") + pads), slide_group + fingers_group, "both"),
            "palm");
  EXPECT_EQ(tip_of(hand(tcp + finger("left") + finger("right")), slide_group + fingers_group, "both"), "tcp");
  const std::string three = fixed("palm", "left") + fixed("palm", "middle") + fixed("palm", "right");
  EXPECT_EQ(tip_of(hand(three), slide_group, "arm"), "palm");
  EXPECT_NE(doubt(hand(three), "", slide_group, "arm")
                .find("the tip is link 'palm', on which left, middle, right hang, because neither --tip nor"),
            std::string::npos);
}

/// A group of the slide and of these joints.
std::string slide_with(const std::vector<std::string>& links) {
  std::string group = "<group name='arm'><joint name='slide'/>";
  for (const std::string& link : links) group += "<joint name='" + link + "_joint'/>";
  return group + "</group>";
}
/// A link that turns on its parent, by its own joint or as `like`'s turns.
std::string turning(const std::string& parent, const std::string& name, const std::string& like = "") {
  const std::string mimic = like.empty() ? "" : "<mimic joint='" + like + "_joint' multiplier='-1'/>";
  return "<link name='" + name + "'/>" +
         urdf_joint(name + "_joint", "revolute", parent, name, "0 0 0", "0 0 1", urdf_limit(-1, 1) + mimic);
}
/// Links that turn one on the other: name1, name2, … The names of all go into `links`.
std::string turning_chain(const std::string& parent, const std::string& name, int count,
                          std::vector<std::string>& links) {
  std::string urdf, on = parent;
  for (int i = 1; i <= count; ++i) {
    links.push_back(name + std::to_string(i));
    urdf += turning(on, links.back());
    on = links.back();
  }
  return urdf;
}

/// Robotiq's 2F-85: on each side a knuckle with the finger and its tip, and another that keeps it parallel.
TEST(TipChoice, OfAGroupIsNoFingerOfAGripperWhoseJointsMimicOne) {
  std::string gripper;
  for (const std::string side : {"left", "right"}) {
    const std::string knuckle = side + "_outer_knuckle", like = side == "left" ? "" : "left_outer_knuckle";
    gripper += turning("palm", knuckle, like) + fixed(knuckle, side + "_outer_finger") +
               turning(side + "_outer_finger", side + "_inner_finger", "left_outer_knuckle") +
               turning("palm", side + "_inner_knuckle", "left_outer_knuckle");
  }
  EXPECT_EQ(tip_of(hand(gripper), slide_with({"left_outer_knuckle"}), "arm"), "palm");
}

/// Two fingers of two joints, Barrett's three of two or three, Allegro's four of four on mounts of their own.
TEST(TipChoice, OfAGroupIsNoFingerOfSeveralJoints) {
  for (const std::vector<int>& joints :
       std::vector<std::vector<int>>{{2, 2}, {3, 3, 2}, {2, 3, 3}, {4, 4, 4, 4}}) {
    std::vector<std::string> links;
    std::string fingers;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const std::string name = "finger" + std::to_string(i) + "_";
      fingers += fixed("palm", name + "mount") + turning_chain(name + "mount", name, joints[i], links);
    }
    EXPECT_EQ(tip_of(hand(fingers + fixed("palm", "tcp") + fixed("tcp", "tool")), slide_with(links), "arm"),
              "tool")
        << joints.size();
  }
}

TEST(TipChoice, OfAGroupOfTwoArmsOnATorsoIsNotTheTorso) {
  std::vector<std::string> links;
  const std::string arms = turning_chain("palm", "l", 6, links) + turning_chain("palm", "r", 6, links);
  EXPECT_EQ(tip_of(hand(arms), slide_with(links), "arm"), "l6");
  const std::string fingers = turning("l6", "f") + turning("l6", "g", "f");
  links.emplace_back("f");
  EXPECT_EQ(tip_of(hand(arms + fingers), slide_with(links), "arm"), "l6");
}

/// A palletizer's rods turn with its arms and end beside them.
TEST(TipChoice, OfAGroupIsBehindTheParallelogramsOfItsArm) {
  std::vector<std::string> links;
  const std::string arm = turning_chain("palm", "arm", 4, links) + turning("palm", "rod", "arm1") +
                          turning("arm1", "lever", "arm2") + turning("arm3", "level", "arm2");
  EXPECT_EQ(tip_of(hand(arm), slide_with(links), "arm"), "arm4");
}

TEST(TipChoice, OfOneBranchIsNoQuestion) {
  EXPECT_EQ(doubt(hand("")), "");
  EXPECT_EQ(doubt(hand(fixed("palm", "tcp"))), "");
  EXPECT_EQ(doubt(hand(fixed("palm", "flange") + fixed("flange", "tcp") + fixed("rail", "stand"))), "");
}

TEST(TipChoice, NamesEndsThatAreAsDeep) {
  const std::string said = doubt(hand(fixed("palm", "a") + fixed("palm", "b")));
  EXPECT_NE(said.find("the tip is link 'palm', on which a, b hang, because neither --tip nor"),
            std::string::npos)
      << said;
}

/// Fingers and cameras are no other tips, nor is what hangs on a tool's frame.
TEST(TipChoice, OfAHandIsNoQuestion) {
  for (const std::string& urdf :
       {hand(finger("left") + finger("right")), hand(finger("left") + finger("right") + fixed("palm", "tcp")),
        hand(finger("left") + fixed("left", "pad") + fixed("palm", "tcp")),
        hand(fixed("palm", "camera") + fixed("palm", "left_finger")),
        hand(fixed("palm", "tcp") + fixed("tcp", "a") + fixed("tcp", "b"))})
    EXPECT_EQ(doubt(urdf), "") << urdf;
}

TEST(TipChoice, NamesALastJointThatMovesItAsAFinger) {
  const std::string said = doubt(hand(fixed("palm", "camera") + finger("boom")));
  EXPECT_NE(said.find("the tip is link 'boom'"), std::string::npos) << said;
  EXPECT_NE(said.find("joint 'boom_joint' moves it against camera"), std::string::npos) << said;
  std::vector<std::string> links;
  const std::string alone =
      doubt(hand(turning_chain("palm", "j", 4, links) + "<link name='quill'/>" +
                 urdf_joint("feed", "prismatic", "j4", "quill", "0 0 0", "0 1 0", urdf_limit(0, 0.1))));
  EXPECT_EQ(alone, "") << "the axis of a tool, for all that is said";
}

TEST(TipChoice, IsNoQuestionWhereSomebodyChoseIt) {
  const std::string urdf = hand(finger("left") + finger("right") + fixed("palm", "a") + fixed("palm", "b"));
  EXPECT_EQ(doubt(urdf, "tip: {link: a}\n"), "");
  EXPECT_NE(doubt(urdf, "fixed: {left_joint: 0.02}\n"), "");
  const std::string group = "<group name='arm'><chain base_link='rail' tip_link='palm'/></group>";
  EXPECT_EQ(doubt(urdf, "", group, "arm"), "");
  EXPECT_NE(doubt(urdf, "", group), "");  // without the group its chain does not count
  const std::string joints = "<group name='arm'><joint name='slide'/></group>";
  EXPECT_EQ(doubt(urdf, "",
                  joints + "<end_effector name='hand' parent_link='palm' group='fingers' "
                           "parent_group='arm'/><group name='fingers'><link name='left'/></group>",
                  "arm"),
            "");
  EXPECT_EQ(tip_doubt(Robot()), "");
}

/// Without a SRDF, and where joints of hand and arm are fixed.
TEST(TipChoice, WithoutAGroupIsWhatTheJointsSay) {
  std::vector<std::string> links;
  const std::string arm = turning_chain("palm", "wrist", 3, links) + fixed("wrist3", "tool0");
  const std::string grips = finger("left") + finger("right");
  TemporaryFolder folder;
  RobotRequest request{folder.write("hand.urdf", hand(arm + grips))};
  const auto tip = [&](const std::map<std::string, double>& held) {
    request.fixed = held;
    const Robot robot = load_robot(request);
    EXPECT_EQ(robot.tip_choice.source, TipSource::joints);
    return tip_name(robot);
  };
  EXPECT_EQ(tip({}), "tool0");
  EXPECT_EQ(tip({{"wrist3_joint", 0.3}}), "tool0");
  EXPECT_EQ(tip({{"wrist2_joint", 0.3}, {"wrist3_joint", 0.3}, {"left_joint", 0.0}}), "tool0");
}

/// A joint of the planning group that somebody fixes is between arm and hand all the same.
TEST(TipChoice, OfAGroupDoesNotChangeWhereItsLastJointIsFixed) {
  std::vector<std::string> links;
  const std::string arm =
      hand(turning_chain("palm", "wrist", 3, links) + fixed("wrist3", "mount") + finger("other"));
  const std::string effector =
      "<group name='fingers'><link name='mount'/></group>"
      "<end_effector name='gripper' parent_link='mount' group='fingers'/>";
  for (const std::string& srdf : {slide_with(links), slide_with(links) + effector}) {
    TemporaryFolder folder;
    RobotRequest request{folder.write("hand.urdf", arm)};
    folder.write("hand.srdf", "<robot name='hand'>" + srdf + "</robot>");
    request.group = "arm";
    request.fixed = {{"wrist3_joint", 0.5}};
    const Robot robot = load_robot(request);
    EXPECT_EQ(tip_name(robot), "mount") << srdf;
    EXPECT_EQ(robot.tip_choice.source, srdf == slide_with(links) ? TipSource::joints : TipSource::srdf);
    EXPECT_TRUE(robot_notes(robot).empty()) << robot_notes(robot).front();
  }
}

TEST(TipChoice, OfSeveralArmsMustBeChosen) {
  std::vector<std::string> links;
  const std::string arms = hand(turning_chain("palm", "l", 6, links) + turning_chain("palm", "r", 6, links));
  TemporaryFolder folder;
  RobotRequest request{folder.write("hand.urdf", arms)};
  const Robot robot = load_robot(request);
  EXPECT_NE(tip_doubt(robot).find("the tip is link 'l6'"), std::string::npos);
  EXPECT_NE(tip_doubt(robot).find("and r6 is the end of another arm"), std::string::npos) << tip_doubt(robot);
  try {
    require_one_tip(robot);
    FAIL() << "took one of two arms";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "robot 'hand' has several arms, and its tip could be link 'l6', r6: expected --tip, a planning "
        "group (--group), or tip: in its settings");
  }
  require_one_tip(with_tip(robot, "r6"));
  for (int i = 1; i <= 6; ++i) request.fixed["l" + std::to_string(i) + "_joint"] = 0.0;
  require_one_tip(load_robot(request));
  EXPECT_EQ(tip_name(load_robot(request)), "r6");
  request.fixed.clear();
  folder.write("hand.yaml", "tip: {link: l6}\n");
  require_one_tip(load_robot(request));
}

}  // namespace tip_choice_test
}  // namespace clearway
