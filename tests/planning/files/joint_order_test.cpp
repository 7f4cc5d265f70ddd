#include "planning/files/joint_order.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "mapping/free_space_map.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace joint_order_test {

Configuration one_to_six(double from) { return Configuration::LinSpaced(6, from, from + 5.0); }

/// The plan of a foreign program, whose joints stand from hand to base.
Plan backwards(const Robot& robot) {
  Plan plan;
  for (auto joint = robot.joints.rbegin(); joint != robot.joints.rend(); ++joint)
    plan.joints.push_back(joint->name);
  plan.start = one_to_six(1.0).reverse();
  plan.goals = {one_to_six(7.0).reverse()};
  PlanResult leg;
  leg.waypoints = {plan.start, plan.goals.front()};
  plan.legs = {leg};
  return plan;
}

TEST(JointOrder, APlanOfTheSameJointsIsTurnedAndAnotherOneRefused) {
  const Robot robot = load_robot("puma560");
  Plan plan = backwards(robot);
  const Plan turned = in_order_of(robot, plan);
  EXPECT_EQ(turned.start, one_to_six(1.0));
  EXPECT_EQ(turned.goals.front(), one_to_six(7.0));
  EXPECT_EQ(turned.waypoints().back(), one_to_six(7.0));
  EXPECT_EQ(complaint([&] { require_joint_order(robot, turned); }), "");
  EXPECT_NE(complaint([&] { require_joint_order(robot, plan); }).find("another order"), std::string::npos);
  plan.joints.front() = "other";
  EXPECT_EQ(in_order_of(robot, plan).joints, plan.joints);
  EXPECT_NE(complaint([&] { require_joint_order(robot, plan); }).find("its joints other, "),
            std::string::npos);
  plan.joints.clear();
  EXPECT_EQ(complaint([&] { require_joint_order(robot, plan); }), "");
}

/// Whoever takes a plan for a robot takes it by its joints' names, not by their places.
TEST(JointOrder, WhatIsMadeOfAPlanAsksForItsOrder) {
  const Robot robot = load_robot("puma560");
  const Plan plan = backwards(robot);
  const Snapshot map = FreeSpaceMap({.resolution = 0.05}).snapshot();
  for (const auto& call : std::vector<std::function<void()>>{
           [&] { legs_of(plan, robot, map); }, [&] { trajectory_of(robot, plan, 1.0); },
           [&] { plan_motion(ConfigurationSpace(robot, map, {}, {}), plan, {}, 1.0); }})
    EXPECT_NE(complaint(call).find("another order"), std::string::npos);
}

}  // namespace joint_order_test
}  // namespace clearway
