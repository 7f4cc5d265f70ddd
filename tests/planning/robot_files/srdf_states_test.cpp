// States of a SRDF that speak of joints which do not move, and neighbours that it wants tested.
#include <gtest/gtest.h>

#include "planning/check/path_check.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot/held_joints.hpp"
#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace srdf_states_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;

/// Three bars in a row, each on a joint that turns about z.
std::string three_bars() {
  std::string links = "<robot name='r'><link name='base'/>";
  for (const char* link : {"l1", "l2", "l3"})
    links += urdf_link(link, "0.2 0 0", "<box size='0.3 0.05 0.05'/>");
  const std::string turn = urdf_limit(-3.14, 3.14);
  return links + urdf_joint("j1", "revolute", "base", "l1", "0 0 0", "0 0 1", turn) +
         urdf_joint("j2", "revolute", "l1", "l2", "0.42 0 0", "0 0 1", turn) +
         urdf_joint("j3", "revolute", "l2", "l3", "0.42 0 0", "0 0 1", turn) + "</robot>";
}

const std::string inner_and_outer =
    "<robot name='r'><group name='g'><joint name='j1'/><joint name='j3'/></group>"
    "<group name='all'><joint name='j1'/><joint name='j2'/><joint name='j3'/></group>"
    "<group_state name='own' group='g'><joint name='j1' value='0.2'/><joint name='j3' value='0.1'/>"
    "<joint name='j2' value='0.7'/></group_state>"
    "<group_state name='still' group='g'><joint name='j1' value='0.2'/><joint name='j3' value='0.1'/>"
    "</group_state><group_state name='still' group='all'><joint name='j2' value='0.9'/></group_state>"
    "<group_state name='whole' group='all'><joint name='j1' value='0.2'/><joint name='j2' value='0.9'/>"
    "<joint name='j3' value='0.1'/></group_state>";

class SrdfStates : public ::testing::Test {
 protected:
  Robot robot(const std::string& srdf, const std::map<std::string, double>& fixed = {}) const {
    const std::string urdf = folder_.write("r.urdf", three_bars());
    return load_robot(RobotRequest{urdf, folder_.write("r.srdf", srdf), "g", fixed});
  }
  static std::string refusal(const Robot& robot, const std::string& state) {
    try {
      named_configuration(robot, state);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }
  RobotFolder folder_;
};

TEST_F(SrdfStates, AStateThatHasAHeldJointElsewhereIsRefusedWithTheRemedy) {
  const std::string passive = "<passive_joint name='j2'/>", end = "</robot>";
  for (const std::string& extra : {std::string(), passive}) {
    const Robot held = robot(inner_and_outer + extra + end);
    EXPECT_NE(refusal(held, "own").find("has joint 'j2' at 0.7, which is held at 0: expected --fix j2=0.7"),
              std::string::npos)
        << refusal(held, "own");
    EXPECT_NE(refusal(held, "whole").find("--fix j2=0.9"), std::string::npos);
    EXPECT_EQ(refusal(held, "still"), "");  // what other groups' states add to the group's own is theirs
  }
  for (const double value : {0.7, 0.0}) {  // whoever fixes it knows where it is
    const Robot fixed = robot(inner_and_outer + end, {{"j2", value}});
    EXPECT_EQ(refusal(fixed, "own"), "");
    EXPECT_EQ(refusal(fixed, "whole"), "");
  }
}

TEST_F(SrdfStates, WhatMimicsAHeldJointIsHeldAndToldToo) {
  std::string urdf = three_bars();
  urdf.insert(urdf.find("</robot>"),
              urdf_link("l4", "0.2 0 0", "<box size='0.3 0.05 0.05'/>") +
                  urdf_joint("j4", "revolute", "l1", "l4", "0.42 0 0.3", "0 0 1",
                             urdf_limit(-3, 3) + "<mimic joint='j2' multiplier='2' offset='0.1'/>"));
  const auto with = [&](double value, const std::map<std::string, double>& fixed = {}) {
    const std::string state =
        "<group_state name='s' group='g'><joint name='j1' value='0'/><joint name='j3' "
        "value='0'/><joint name='j4' value='" +
        std::to_string(value) + "'/></group_state></robot>";
    const std::string group = "<robot name='r'><group name='g'><joint name='j1'/><joint name='j3'/></group>";
    return refusal(load_robot(RobotRequest{folder_.write("m.urdf", urdf),
                                           folder_.write("m.srdf", group + state), "g", fixed}),
                   "s");
  };
  EXPECT_EQ(with(0.1), "");
  EXPECT_NE(with(0.7).find("has joint 'j4' at 0.7, which mimics one that is held, and is at 0.1"),
            std::string::npos)
      << with(0.7);
  EXPECT_EQ(with(0.7, {{"j2", 0.3}}), "");
}

TEST_F(SrdfStates, NamesMayHaveBlanksAroundThemForPlannersAndCheck) {
  const Robot padded = robot(
      "<robot name='r'><group name=' g '><joint name='j1 '/><joint name=' j3'/><joint name='j2'/></group>"
      "<passive_joint name=' j2 '/><disable_default_collisions link=' l3 '/></robot>");
  EXPECT_EQ(padded.dof(), 2U);
  EXPECT_TRUE(check_path(padded, Snapshot(), {}, 0.0, {Eigen::Vector2d(0.0, 0.0)}).valid);
  EXPECT_EQ(file_disagreement(padded), "");
}

/// The outer bar folded back onto the middle one: neighbours, of which an SRDF may want that they are tested.
TEST_F(SrdfStates, NeighboursThatAreEnabledMeetInPlannersAndCheck) {
  const std::string group = "<robot name='r'><group name='g'><joint name='j1'/><joint name='j3'/></group>";
  const Snapshot map = VoxelScene{0.05, {box_of(3.0, 3.0, 0.0, 3.1, 3.1, 0.1)}, {}, {}}.snapshot();
  const auto solved = [&](const std::string& pairs) {
    const Robot tested = robot(group + pairs + "</robot>");
    const ConfigurationSpace space(tested, map, {{}, Policy::not_occupied, false}, {});
    return space.is_free(Eigen::Vector2d(0.0, 3.1));
  };
  EXPECT_TRUE(solved(""));
  EXPECT_TRUE(solved("<enable_collisions link1='l1' link2='l2'/>"));
  EXPECT_FALSE(solved("<enable_collisions link1='l3' link2='l2'/>"));
  EXPECT_TRUE(
      solved("<enable_collisions link1='l3' link2='l2'/><disable_collisions link1='l2' link2='l3'/>"));
  Robot passes_over = robot(group + "<enable_collisions link1='l3' link2='l2'/></robot>");
  const Configuration from = Eigen::Vector2d(0.0, 0.0), to = Eigen::Vector2d(0.0, 3.1);
  const auto valid = [&](const Robot& any) { return check_path(any, Snapshot(), {}, 0.0, {from, to}).valid; };
  EXPECT_FALSE(valid(passes_over));
  passes_over.exempt.emplace_back(1, 2);  // a planner that has it wrong
  EXPECT_FALSE(valid(passes_over));
  EXPECT_TRUE(valid(robot(group + "</robot>")));
}

}  // namespace srdf_states_test
}  // namespace clearway
