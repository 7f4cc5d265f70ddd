#include "planning/planned_motion.hpp"

#include <gtest/gtest.h>

#include "planning/plan_and_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/beam_world.hpp"

namespace clearway {
namespace planned_motion_test {

ConfigurationSpace walled_space() {
  const VoxelScene scene{0.05, {box_of(0.9, -0.5, -0.1, 1.1, 0.5, 0.1)}, {}, {}};
  return {load_robot("point"), scene.snapshot(), anywhere_but_occupied(), {.padding = 0.01}};
}

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

TEST(PlannedMotion, GoesRoundTheWallThroughEachGoalAndIsFoundValid) {
  const ConfigurationSpace space = walled_space();
  const Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(2, 0), at(0, 0.5)}});
  ASSERT_TRUE(plan.is_proved());
  const PlannedMotion planned = plan_motion(space, plan);
  EXPECT_TRUE(planned.validation.valid) << planned.validation.fault;
  EXPECT_GT(planned.validation.min_clearance, 0.01);
  ASSERT_EQ(planned.leg_ends.size(), 2U);
  EXPECT_EQ(planned.motion.positions[planned.leg_ends[0]], at(2, 0));
  EXPECT_EQ(planned.motion.positions.back(), at(0, 0.5));
  EXPECT_GT(planned.blended, 0U);
  const Trajectory points = trajectory_of(planned.motion);
  ASSERT_EQ(points.points.size(), planned.motion.positions.size());
  EXPECT_DOUBLE_EQ(points.points.back().time, planned.motion.duration());
  EXPECT_EQ(points.points[7].acceleration, planned.motion.accelerations[7]);
}

TEST(PlannedMotion, ReadsBackFromAPlanFileBitForBitAndAgreesWithTheCheckAgain) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(2, 0)}});
  plan.motion = plan_motion(space, plan, {.scales = {.speed = 0.7, .jerk = 0.5}});
  const Plan again = parse_plan(to_json(plan), "plan");
  ASSERT_TRUE(again.motion);
  EXPECT_EQ(again.motion->motion.positions, plan.motion->motion.positions);
  EXPECT_EQ(again.motion->motion.velocities, plan.motion->motion.velocities);
  EXPECT_EQ(again.motion->leg_ends, plan.motion->leg_ends);
  EXPECT_EQ(again.motion->scales.speed, 0.7);
  const auto verdict =
      check_motion(space.robot(), space.map(), space.policies(), 0.01, again.motion->motion,
                   again.motion->leg_ends, again.stops(), rate_limits(space.robot(), again.motion->scales));
  EXPECT_TRUE(verdict.valid) << verdict.fault;
}

TEST(PlannedMotion, OfAPlanThatIsNotProvedIsRefused) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(1, 0)}});
  EXPECT_THROW(plan_motion(space, plan), std::invalid_argument);
}

}  // namespace planned_motion_test
}  // namespace clearway
