// The check's own reading of a robot's file, and robots that are not what their file says.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include "planning/check/path_check.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace path_check_urdf_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;
using worlds::UrdfRobot;

/// Mimic joints about the master's axis, against it and across it, turning and sliding, with a body each; a
/// continuous joint, an axis that is not of unit length, and a fixed joint that turns the frame.
UrdfRobot menagerie() {
  const auto link = [](const std::string& name) {
    return "<link name='" + name +
           "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
           "iyz='0'/></inertial>"
           "<collision><origin xyz='0.3 0.01 0.02' rpy='0.1 0.2 0.3'/><geometry><capsule radius='0.01' "
           "length='0.1'/></geometry></collision><visual><geometry><mesh "
           "filename='none.dae'/></geometry></visual>"
           "</link>";
  };
  const auto mimic = [](const std::string& of, const std::string& multiplier, const std::string& offset) {
    return urdf_limit(-30, 30) + "<mimic joint='" + of + "' multiplier='" + multiplier + "' offset='" +
           offset + "'/>";
  };
  std::string text = "<material name='grey'/>";
  for (const char* name : {"base", "a", "b", "c", "d", "e", "f", "g", "h"}) text += link(name);
  return {
      "menagerie",
      text + urdf_joint("turn", "revolute", "base", "a", "0 0 1", "0 0 1", urdf_limit(-1, 2)) +
          urdf_joint("same", "revolute", "a", "b", "1 0 0", "0 0 1", mimic("turn", "0.5", "0.1")) +
          urdf_joint("against", "revolute", "b", "c", "1 0 0", "0 0 -1", mimic("turn", "-2", "-0.3")) +
          urdf_joint("across", "revolute", "c", "d", "1 0 0", "0.3 0.5 0.2", mimic("turn", "1.5", "0.2")) +
          urdf_joint("slide", "prismatic", "d", "e", "0 1 0", "0 0 1", urdf_limit(-0.2, 0.3)) +
          urdf_joint("slide_across", "prismatic", "e", "f", "0 1 0", "1 2 3", mimic("slide", "-3", "0.05")) +
          urdf_joint("round", "continuous", "f", "g", "0 0 1", "0 3 4", "") +
          "<joint name='weld' type='fixed'><parent link='g'/><child link='h'/>"
          "<origin xyz='0.1 0.2 0.3' rpy='1 -2 3'/></joint>"
          "<transmission name='t'><type>x</type></transmission>"};
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string contact(const Robot& robot) {
  const Configuration q = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
  return check_path(robot, Snapshot(), {}, 0.0, {q}).first_contact;
}

TEST(PathCheckUrdf, ReadsEveryRobotAsOurReaderDoesAtEveryScale) {
  const UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(), scissors = worlds::scissors(),
                  many = menagerie(), rack = worlds::rack_and_pinion();
  std::vector<Robot> robots{whip.robot(), telescope.robot(), scissors.robot(), many.robot(), rack.robot()};
  for (const auto& [name, description] : available_robots()) robots.push_back(load_robot(name));
  ASSERT_GE(robots.size(), 9u);
  Random random(4);
  for (Robot& robot : robots) {
    for (const double factor : {1.0, 0.1, 3.7}) {
      Robot placed = scaled(robot, factor);
      placed.map_from_base = random.pose(1e8);
      EXPECT_NO_THROW(check::require_same_poses(placed, check::KdlArm(placed))) << robot.name;
    }
  }
}

TEST(PathCheckUrdf, RefusesARobotThatIsNotWhatItsFileSaysAndNamesTheLink) {
  const UrdfRobot many = menagerie();
  const auto altered = [&](const auto& alter) {
    Robot robot = many.robot();
    alter(robot);
    const std::string with_file = contact(robot);
    robot.source.clear();
    EXPECT_EQ(contact(robot).find("kdl_parser"), std::string::npos);  // made in memory: nothing to compare
    return with_file;
  };
  const auto names = [](const std::string& sentence, const std::string& words) {
    return sentence.find("menagerie.urdf says, read again: " + words) != std::string::npos;
  };
  EXPECT_EQ(altered([](Robot&) {}).find("menagerie.urdf"), std::string::npos);
  EXPECT_TRUE(names(altered([](Robot& r) { r.joints[0].axis = {0.0, 2e-9, 1.0}; }), "link 'a'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.links[2].multiplier += 1e-8; }), "link 'b'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.links[3].offset = -r.links[3].offset; }), "link 'c'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.links[4].multiplier *= -1; }), "link 'd'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.joints[1].kind = JointKind::revolute; }), "link 'e'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.links[6].joint = -1; }), "link 'f'"));
  EXPECT_TRUE(
      names(altered([](Robot& r) { r.links[8].parent_from_link.translation().x() += 2e-9; }), "link 'h'"));
  EXPECT_EQ(altered([](Robot& r) { r.links[8].parent_from_link.translation().x() += 5e-10; }), "");
  EXPECT_TRUE(
      names(altered([](Robot& r) { r.links[5].parent_from_link.translation().y() = NAN; }), "link 'e'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.bodies[6].link_from_shape.translation().z() += 1e-6; }),
                    "a body of link 'f'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.bodies.pop_back(); }), "link 'h' has 1 body, not 0"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.bodies.push_back(r.bodies.back()); }), "link 'h' has only 1"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.joints[0].upper += 1e-6; }), "joint 'turn' may move to"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.scale = 1.1; }), ""));
  EXPECT_TRUE(names(altered([](Robot& r) { r.links[8].name = "i"; }), "it has no link 'i'"));
  EXPECT_TRUE(names(altered([](Robot& r) { r.joints[2].name = "rund"; }), "joint 'round' is none"));
}

TEST(PathCheckUrdf, AMimicJointsLimitsBindItsMaster) {
  const UrdfRobot tied("tied",
                       worlds::urdf_link("base", "0 0 0", "<sphere radius='0.1'/>") +
                           worlds::urdf_link("a", "1 0 0", "<sphere radius='0.1'/>") +
                           worlds::urdf_link("b", "1 0 0", "<sphere radius='0.1'/>") +
                           urdf_joint("turn", "revolute", "base", "a", "0 0 0", "0 0 1", urdf_limit(-2, 2)) +
                           urdf_joint("copy", "revolute", "a", "b", "1 0 0", "0 0 1",
                                      urdf_limit(-1, 1) + "<mimic joint='turn' multiplier='2'/>"));
  EXPECT_EQ(tied.robot().joints[0].upper, 0.5);
  EXPECT_EQ(contact(tied.robot()), "");
  Robot wide = tied.robot();
  wide.joints[0].upper = 0.6;
  EXPECT_NE(contact(wide).find("joint 'copy' may move to 1.2, its limits there are -1 to 1"),
            std::string::npos)
      << contact(wide);
}

/// A group of links may name the root, above which there is no joint, and links behind fixed and mimic ones.
TEST(PathCheckUrdf, AGroupMayNameTheRootAndLinksThatNoJointOfItsOwnMoves) {
  const TemporaryFolder folder;
  const std::string sphere = "<sphere radius='0.02'/>";
  const auto file = folder.write(
      "wrist.urdf",
      "<robot name='wrist'>" + urdf_link("root", "0 0 0", sphere) + urdf_link("arm", "0.3 0 0", sphere) +
          urdf_link("weld", "0 0 0", sphere) + urdf_link("geared", "0.3 0 0", sphere) +
          urdf_link("left_out", "0.3 0 0", sphere) +
          urdf_joint("turn", "revolute", "root", "arm", "0 0 0.2", "0 0 1", urdf_limit(-1, 1)) +
          urdf_joint("fixed", "fixed", "arm", "weld", "0.6 0 0", "0 0 1", "") +
          urdf_joint("follow", "revolute", "weld", "geared", "0 0 0.2", "0 0 1",
                     urdf_limit(-3, 3) + "<mimic joint='turn' multiplier='2'/>") +
          urdf_joint("free", "revolute", "geared", "left_out", "0.6 0 0", "0 0 1", urdf_limit(-1, 1)) +
          "</robot>");
  const auto srdf = folder.write("wrist.srdf",
                                 "<robot name='wrist'><group name='all'><link name='root'/><link name='arm'/>"
                                 "<link name='weld'/><link name='geared'/></group></robot>");
  const Robot robot = load_robot({.robot = file, .srdf = srdf, .group = "all"});
  ASSERT_EQ(robot.dof(), 1U);
  const PathVerdict verdict = check_path(robot, Snapshot(), {}, 0.0,
                                         {Configuration::Constant(1, -0.9), Configuration::Constant(1, 0.9)});
  EXPECT_TRUE(verdict.valid) << verdict.first_contact;
  // As the file has the group by now, a joint of it is held.
  folder.write(
      "wrist.srdf",
      "<robot name='wrist'><group name='all'><link name='arm'/><link name='left_out'/></group></robot>");
  EXPECT_NE(contact(robot).find("joint 'free' of group 'all' is held"), std::string::npos) << contact(robot);
  // Or has joints that nobody drives.
  const auto contact_with = [&](const std::string& passive) {
    folder.write("wrist.srdf",
                 "<robot name='wrist'><group name='all'><link name='arm'/></group>"
                 "<passive_joint name='" +
                     passive + "'/></robot>");
    return contact(robot);
  };
  EXPECT_EQ(contact_with("free"), "");
  EXPECT_NE(contact_with(" turn ").find("joint 'turn' is none of group 'all'"), std::string::npos)
      << contact_with(" turn ");
}

TEST(PathCheckUrdf, SoftLimitsBind) {
  for (const std::string type : {"revolute", "prismatic", "continuous"}) {
    const UrdfRobot soft("soft",
                         worlds::urdf_link("base", "0 0 0", "<sphere radius='0.1'/>") +
                             worlds::urdf_link("a", "1 0 0", "<sphere radius='0.1'/>") +
                             urdf_joint("move", type, "base", "a", "0 0 0", "0 0 1",
                                        urdf_limit(-2, 2) + "<safety_controller soft_lower_limit='-0.5' "
                                                            "soft_upper_limit='0.75' k_velocity='1'/>"));
    EXPECT_EQ(soft.robot().joints[0].upper, 0.75) << type;
    EXPECT_EQ(contact(soft.robot()), "") << type;
    Robot wide = soft.robot();
    wide.joints[0].lower = -0.51;
    EXPECT_NE(contact(wide).find("joint 'move' may move to -0.51, its limits there are -0.5 to 0.75"),
              std::string::npos)
        << contact(wide);
  }
}

TEST(PathCheckUrdf, ASlideThatIsHeldStandsWhereTheScaleHasIt) {
  const TemporaryFolder folder;
  const std::string urdf = folder.write("arm.urdf", worlds::arm_with_finger());
  for (const double scale : {1.0, 0.5, 3.0})
    for (const double held : {0.0, 0.04, 0.1}) {
      Robot robot = scaled(load_robot(RobotRequest{urdf, {}, {}, {{"grip", held}}}), scale);
      ASSERT_EQ(robot.held.size(), 1U);
      EXPECT_EQ(file_disagreement(robot), "") << scale << ' ' << held;
      robot.held[0].value = 0.05;
      EXPECT_NE(file_disagreement(robot), "") << scale << ' ' << held;
    }
}

/// Though all is placed as its value says.
TEST(PathCheckUrdf, AJointIsHeldWithinItsLimitsAlone) {
  const TemporaryFolder folder;
  const std::string urdf = folder.write("arm.urdf", worlds::arm_with_finger());  // the grip from 0 to 0.1 m
  for (const auto& [value, is_within] :
       {std::pair(0.0, true), {0.1, true}, {0.1001, false}, {-1e-4, false}}) {
    Robot robot = load_robot(RobotRequest{urdf, {}, {}, {{"grip", 0.05}}});
    ASSERT_EQ(robot.held.size(), 1U);
    robot.held[0].value = value;
    robot.links.back().parent_from_link.translation().x() += value - 0.05;
    const std::string disagreement = file_disagreement(robot);
    EXPECT_EQ(disagreement.empty(), is_within) << value << disagreement;
    EXPECT_EQ(disagreement.find("joint 'grip' may move to") == std::string::npos, is_within) << disagreement;
  }
}

TEST(PathCheckUrdf, AFileThatChangedAfterItWasLoadedRefusesThePlanAndOneThatIsGoneIsReported) {
  const UrdfRobot whip = worlds::whip();
  const Robot robot = whip.robot();
  ASSERT_EQ(contact(robot), "");
  const std::string text = text_of(robot.source);
  std::string longer = text;
  longer.replace(longer.find("0.4"), 3, "0.5");
  for (const std::string& now :
       {std::string(), std::string("<robot"), std::string("<robot/>"), text.substr(0, text.size() / 2)}) {
    std::ofstream(robot.source) << now;
    EXPECT_NE(contact(robot).find("whip.urdf says, read again"), std::string::npos) << contact(robot);
  }
  std::filesystem::remove(robot.source);
  EXPECT_THROW(contact(robot), std::invalid_argument);
}

TEST(PathCheckUrdf, AnyNumberThatPlacesAnythingIsComparedWithTheFile) {
  const UrdfRobot many = menagerie();
  const Robot robot = many.robot();
  const std::string text = text_of(robot.source);
  const std::regex attribute("(<axis )?(xyz|rpy|multiplier|offset)='([^']*)'");
  int changed = 0;
  for (auto found = std::sregex_iterator(text.begin(), text.end(), attribute);
       found != std::sregex_iterator(); ++found) {
    const std::string values = found->str(3);
    std::istringstream words(values);
    std::vector<double> numbers;
    for (double number = 0.0; words >> number;) numbers.push_back(number);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      std::vector<double> others = numbers;
      others[i] += 0.01;
      if (found->length(1) > 0 &&
          Eigen::Vector3d(others.data()).cross(Eigen::Vector3d(numbers.data())).norm() == 0.0)
        continue;  // only its length
      std::ostringstream now;
      for (const double number : others) now << number << ' ';
      std::string other = text;
      other.replace(static_cast<std::size_t>(found->position(3)), values.size(), now.str());
      std::ofstream(robot.source) << other;
      EXPECT_NE(contact(robot).find("read again"), std::string::npos)
          << found->str() << " with " << now.str();
      ++changed;
    }
  }
  EXPECT_GT(changed, 100);
  std::ofstream(robot.source) << text;
  EXPECT_EQ(contact(robot).find("read again"), std::string::npos) << contact(robot);
}

TEST(PathCheckUrdf, AChainMayHaveFiveHundredJointsAndNoMore) {
  const TemporaryFolder folder;
  const auto chain = [](int joints) {
    std::string text =
        "<robot name='chain'><link name='l0'/>" + urdf_link("l1", "0 0 0", "<sphere radius='0.1'/>");
    for (int i = 1; i <= joints; ++i) {
      const std::string number = std::to_string(i);
      text += (i == 1 ? "" : "<link name='l" + number + "'/>") +
              urdf_joint("j" + number, i == 1 ? "revolute" : "fixed", "l" + std::to_string(i - 1),
                         "l" + number, "0 0 0.01", "0 0 1", i == 1 ? urdf_limit(-1, 1) : "");
    }
    return text + "</robot>";
  };
  const auto file = folder.write("chain.urdf", chain(500));
  const Robot robot = load_robot(file);
  EXPECT_EQ(check::model_of_file(robot).links.size(), 501U);
  folder.write("chain.urdf", chain(501));
  EXPECT_NE(contact(robot).find("more than 500 joints"), std::string::npos) << contact(robot);
}

TEST(PathCheckUrdf, ALimitIsBeyondThatOfTheFileByItsToleranceAtMost) {
  const UrdfRobot many = menagerie();
  const auto of_limits = [&](double lower, double upper) {
    Robot robot = many.robot();
    robot.joints[0].lower = lower;
    robot.joints[0].upper = upper;
    return contact(robot);
  };
  EXPECT_EQ(of_limits(-1.0 - 1e-9, 2.0), "");
  EXPECT_EQ(of_limits(-1.0, 2.0 + 1e-9), "");
  EXPECT_NE(of_limits(-1.0 - 1.1e-9, 2.0).find("joint 'turn' may move to"), std::string::npos);
  EXPECT_NE(of_limits(-1.0, 2.0 + 1.1e-9).find("joint 'turn' may move to"), std::string::npos);
}

}  // namespace path_check_urdf_test
}  // namespace clearway
