#include "planning/planned_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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
  EXPECT_TRUE(check_planned_motion(space, again).valid);
}

TEST(PlannedMotion, IsCheckedAgainWhateverItsPlanSaysOfIt) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(2, 0)}});
  plan.motion = plan_motion(space, plan);
  ASSERT_TRUE(check_planned_motion(space, plan).valid);
  Plan through = plan;  // the wall, slowly and smoothly
  Motion& motion = through.motion->motion;
  const std::size_t last = motion.positions.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    motion.positions[k] = at(2.0 * static_cast<double>(k) / static_cast<double>(last), 0.0);
    motion.velocities[k] = Eigen::VectorXd::Zero(2);
  }
  motion.accelerations = hermite_accelerations(motion);
  EXPECT_TRUE(through.motion->validation.valid);
  const MotionVerdict verdict = check_planned_motion(space, through);
  EXPECT_FALSE(verdict.valid);
  EXPECT_NE(verdict.fault, "");
  Plan loaded = plan;
  loaded.loads.emplace_back();
  EXPECT_FALSE(check_planned_motion(space, loaded).valid);
}

TEST(PlannedMotion, IsGivenToPlansThatCanHaveOneAndTheOthersGoEdgeByEdge) {
  const ConfigurationSpace space = walled_space();
  PlanQuery query{.space = space, .start = at(0, 0), .goals = {at(2, 0), at(0, 0.5)}};
  Plan plan = plan_and_check(query);
  give_motion(space, plan);
  ASSERT_TRUE(plan.motion);
  EXPECT_EQ(plan.motion_caveat, "");
  const auto positions = [](const Trajectory& trajectory) {
    std::vector<Configuration> list;
    for (const TrajectoryPoint& point : trajectory.points) list.push_back(point.position);
    return list;
  };
  EXPECT_EQ(positions(trajectory_of(space.robot(), plan)), plan.motion->motion.positions);
  plan.motion.reset();
  EXPECT_EQ(positions(trajectory_of(space.robot(), plan)),
            positions(time_parameterize(space.robot(), plan.waypoints())));
  // A motion that would be too long, and one of a robot that carries something.
  give_motion(space, plan, {.scales = {.jerk = 1e-9}});
  EXPECT_FALSE(plan.motion);
  EXPECT_NE(plan.motion_caveat.find("jerk"), std::string::npos) << plan.motion_caveat;
  LegLoad ball;
  ball.load.name = "ball";
  ball.load.link = "base";
  ball.load.shape = Shape::sphere(0.05);
  query.loads = {ball};
  Plan loaded = plan_and_check(query);
  ASSERT_TRUE(loaded.is_proved());
  give_motion(space, loaded);
  EXPECT_FALSE(loaded.motion);
  EXPECT_NE(loaded.motion_caveat.find("edge by edge"), std::string::npos);
  const auto stopping = trajectory_of(space.robot(), loaded).points;
  const auto at_goal = std::find_if(stopping.begin(), stopping.end(),
                                    [](const TrajectoryPoint& point) { return point.position == at(2, 0); });
  ASSERT_NE(at_goal, stopping.end());
  EXPECT_LT(at_goal->velocity.norm(), 1e-9);
  EXPECT_TRUE(trajectory_of(space.robot(), loaded).events.empty());  // it rides from the beginning on
}

/// Whole periods at rest where a load begins or ends to ride, and nothing else differs.
TEST(PlannedMotion, RestsWhereLoadsAreTakenAndLeft) {
  const ConfigurationSpace space = walled_space();
  PlanQuery query{.space = space, .start = at(0, 0), .goals = {at(2, 0), at(0, 0.5), at(0, 0)}};
  LegLoad ball;
  ball.load.name = "ball";
  ball.load.link = "base";
  ball.load.shape = Shape::sphere(0.05);
  ball.legs = {1};
  query.loads = {ball};
  const Plan plan = plan_and_check(query);
  ASSERT_TRUE(plan.is_proved());
  const Trajectory at_once = trajectory_of(space.robot(), plan, 0.0);
  const Trajectory motion = trajectory_of(space.robot(), plan, 0.5);
  ASSERT_EQ(motion.events.size(), 2u);
  EXPECT_EQ(motion.events[0].kind, TrajectoryEvent::Kind::attach);
  EXPECT_EQ(motion.events[1].kind, TrajectoryEvent::Kind::detach);
  std::size_t next = 0;
  double rested = 0.0;
  for (const TrajectoryPoint& point : at_once.points) {
    ASSERT_LT(next, motion.points.size());
    EXPECT_EQ(motion.points[next].position, point.position);
    EXPECT_NEAR(motion.points[next].time, point.time + rested, 1e-9);
    ++next;
    for (const TrajectoryEvent& event : motion.events) {
      if (event.time != motion.points[next - 1].time) continue;
      EXPECT_EQ(event.load, "ball");
      EXPECT_EQ(point.position, &event == &motion.events[0] ? at(2, 0) : at(0, 0.5));
      EXPECT_GE(event.rest, 0.5);
      EXPECT_LT(event.rest, 0.5 + motion.sampling_period);
      for (; next < motion.points.size() && motion.points[next].time <= event.time + event.rest + 1e-9;
           ++next) {
        EXPECT_EQ(motion.points[next].position, point.position);
        EXPECT_LT(motion.points[next].velocity.norm(), 1e-9);
      }
      rested += event.rest;
    }
  }
  EXPECT_EQ(next, motion.points.size());
  EXPECT_GT(rested, 0.99);
}

TEST(PlannedMotion, ThatTorquesForbidIsNoneAndSaysSo) {
  const Robot robot = load_robot("panda");
  const VoxelScene scene{0.05, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)}, {}, {}};
  const ConfigurationSpace space(robot, scene.snapshot(), anywhere_but_occupied());
  Configuration from(7), to(7);
  from << 0, -0.5, 0, -2.0, 0, 1.6, 0;
  to << 1.2, 0.2, 0.3, -1.2, 0.4, 2.2, 0.5;
  Plan plan = plan_and_check(
      {.space = space, .start = from, .goals = {to}, .payload = 500.0, .survey = std::nullopt});
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  give_motion(space, plan);
  EXPECT_FALSE(plan.motion);
  EXPECT_NE(plan.motion_caveat.find("the check refuses it: motion: after"), std::string::npos)
      << plan.motion_caveat;
  EXPECT_NE(plan.motion_caveat.find("torque of joint"), std::string::npos);
  Plan refused = plan_and_check({.space = space, .start = from, .goals = {100.0 * to}});
  give_motion(space, refused);
  EXPECT_EQ(refused.motion_caveat, "");
}

TEST(PlannedMotion, OfAPlanThatIsNotProvedIsRefused) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(1, 0)}});
  EXPECT_THROW(plan_motion(space, plan), std::invalid_argument);
}

}  // namespace planned_motion_test
}  // namespace clearway
