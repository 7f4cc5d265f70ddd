// Names of foreign files as the robot's own.
#include "apps/problem_sets/own_names.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace own_names_test {

using ByJoint = std::map<std::string, double>;

ForeignState state(const ByJoint& by_joint) { return {by_joint, {}}; }

/// MoveIt's Panda has fingers, which states name and our robot lacks.
TEST(OwnNames, OfJointsThatTheRobotLacksStandForNone) {
  const Robot panda = load_robot("panda");
  ForeignProblem problem;
  problem.start = state({{"panda_joint1", 0.1},
                         {"panda_joint2", 0.2},
                         {"panda_finger_joint1", 0.01},
                         {"panda_finger_joint2", 0.02}});
  problem.goals = {{state({{"panda_joint1", 0.3}})}, {state({{"panda_finger_joint1", 0.04}})}};
  const ForeignProblem own = with_names_of(panda, problem);
  EXPECT_EQ(
      own.start.by_joint,
      (ByJoint{
          {"joint1", 0.1}, {"joint2", 0.2}, {"panda_finger_joint1", 0.01}, {"panda_finger_joint2", 0.02}}));
  EXPECT_EQ(own.goals[0].joints.by_joint, (ByJoint{{"joint1", 0.3}}));
  EXPECT_EQ(own.goals[1].joints.by_joint, (ByJoint{{"panda_finger_joint1", 0.04}}));
}

TEST(OwnNames, AnOwnNameIsTheRobotsWhateverElseEndsInIt) {
  const Robot panda = load_robot("panda");
  ForeignProblem problem;
  problem.start = state({{"joint1", 0.1}, {"gripper_joint1", 0.2}});
  problem.goals = {{state({{"arm_joint1", 0.3}})}};
  const ForeignProblem own = with_names_of(panda, problem);
  EXPECT_EQ(own.start.by_joint, (ByJoint{{"joint1", 0.1}, {"gripper_joint1", 0.2}}));
  EXPECT_EQ(own.goals[0].joints.by_joint, (ByJoint{{"joint1", 0.3}}));
}

TEST(OwnNames, OfTwoArmsAreRefused) {
  ForeignProblem problem;
  problem.start = state({{"left_joint1", 0.1}, {"right_joint1", 0.2}});
  EXPECT_THROW(with_names_of(load_robot("panda"), problem), std::invalid_argument);
}

TEST(OwnNames, OfLinksAreThoseOfTheSamePrefix) {
  ForeignAttached body;
  body.link = body.frame = "panda_hand";
  body.touches = {"panda_link7", "panda_camera_hand", "table"};
  ForeignProblem problem;
  problem.attached = {body};
  const ForeignAttached own = with_names_of(load_robot("panda"), problem).attached[0];
  EXPECT_EQ(own.link, "hand");
  EXPECT_EQ(own.frame, "hand");
  EXPECT_EQ(own.touches, (std::vector<std::string>{"link7", "panda_camera_hand", "table"}));
}

}  // namespace own_names_test
}  // namespace clearway
