#include "planning/planned_motion.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "planning/plan_and_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"
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
  EXPECT_TRUE(check_planned_motion(space, again, space.policies()).valid);
}

TEST(PlannedMotion, EndsOfLegsInAFileAreKnotsInOrderAndAsManyAsLegs) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(2, 0), at(0, 0.5)}});
  plan.motion = plan_motion(space, plan);
  const std::size_t knots = plan.motion->motion.positions.size();
  for (const std::vector<std::size_t>& ends :
       {std::vector<std::size_t>{3, knots}, std::vector<std::size_t>{knots - 1, 3}}) {
    plan.motion->leg_ends = ends;
    try {
      parse_plan(to_json(plan), "plan");
      FAIL() << ends[0] << " " << ends[1];
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("leg_ends[1]"), std::string::npos) << error.what();
    }
  }
  plan.motion->leg_ends = {knots - 1};
  const Plan shorter = parse_plan(to_json(plan), "plan");
  EXPECT_THROW(trajectory_of(space.robot(), shorter), std::invalid_argument);
  EXPECT_THROW(leg_trajectories(space.robot(), shorter), std::invalid_argument);
}

TEST(PlannedMotion, IsCheckedAgainWhateverItsPlanSaysOfIt) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(2, 0)}});
  plan.motion = plan_motion(space, plan);
  ASSERT_TRUE(check_planned_motion(space, plan, space.policies()).valid);
  Plan through = plan;  // the wall, slowly and smoothly
  Motion& motion = through.motion->motion;
  const std::size_t last = motion.positions.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    motion.positions[k] = at(2.0 * static_cast<double>(k) / static_cast<double>(last), 0.0);
    motion.velocities[k] = Eigen::VectorXd::Zero(2);
  }
  motion.accelerations = hermite_accelerations(motion);
  EXPECT_TRUE(through.motion->validation.valid);
  const MotionVerdict verdict = check_planned_motion(space, through, space.policies());
  EXPECT_FALSE(verdict.valid);
  EXPECT_NE(verdict.fault, "");
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
  // A motion that would be too long.
  give_motion(space, plan, {.scales = {.jerk = 1e-9}});
  EXPECT_FALSE(plan.motion);
  EXPECT_NE(plan.motion_caveat.find("jerk"), std::string::npos) << plan.motion_caveat;
}

/// Beside the robot, so that it comes to the wall first.
LegLoad ball_on(std::vector<int> legs, double radius = 0.2) {
  LegLoad ball;
  ball.load.name = "ball";
  ball.load.link = "base";
  ball.load.link_from_load.translation() << 0.0, -0.1, 0.0;
  ball.load.shape = Shape::sphere(radius);
  ball.load.mass = 0.5;
  ball.legs = std::move(legs);
  return ball;
}

PlanQuery out_and_back(const ConfigurationSpace& space, std::vector<LegLoad> loads) {
  return {.space = space,
          .start = at(0, 0),
          .goals = {at(2, 0), at(0, 0.5), at(0, 0)},
          .loads = std::move(loads)};
}

/// How far the ball is from the wall at least, every millisecond of a leg of a motion: by its place alone.
double least_gap(const PlannedMotion& planned, std::size_t leg, double radius) {
  const double begin =
                   leg == 0 ? 0.0 : planned.motion.period * static_cast<double>(planned.leg_ends[leg - 1]),
               end = planned.motion.period * static_cast<double>(planned.leg_ends[leg]);
  double least = HUGE_VAL;
  for (double time = begin; time <= end; time += 1e-3) {
    const Eigen::Vector2d ball = planned.motion.at(time).position + Eigen::Vector2d(0.0, -0.1);
    const Eigen::Vector2d off =
        (Eigen::Vector2d(0.9, -0.5) - ball).cwiseMax(ball - Eigen::Vector2d(1.1, 0.5)).cwiseMax(0.0);
    least = std::min(least, off.norm() - radius);
  }
  return least;
}

TEST(PlannedMotion, WithALoadIsSmoothKeepsTheLoadClearAndRestsWhereItIsTakenAndLeft) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check(out_and_back(space, {ball_on({1})}));
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  give_motion(space, plan, {}, 0.5);
  ASSERT_TRUE(plan.motion) << plan.motion_caveat;
  EXPECT_TRUE(check_planned_motion(space, plan, plan.policies).valid);
  EXPECT_GT(plan.motion->blended, 0U);
  EXPECT_GE(least_gap(*plan.motion, 1, 0.2), 0.01);
  EXPECT_LT(least_gap(*plan.motion, 0, 0.2), 0.01);  // the empty hand goes nearer
  const Trajectory motion = trajectory_of(space.robot(), plan);
  ASSERT_EQ(motion.events.size(), 2U);
  EXPECT_EQ(motion.events[0].kind, TrajectoryEvent::Kind::attach);
  EXPECT_EQ(motion.events[1].kind, TrajectoryEvent::Kind::detach);
  for (const TrajectoryEvent& event : motion.events) {
    EXPECT_NEAR(event.rest, 0.5, 0.008);
    for (double time = event.time; time <= event.time + event.rest; time += 1e-3)
      EXPECT_EQ(plan.motion->motion.at(time).position,
                event.kind == TrajectoryEvent::Kind::attach ? at(2, 0) : at(0, 0.5));
  }
  const Plan again = parse_plan(to_json(plan), "plan");
  EXPECT_EQ(again.motion->grip_time, 0.5);
  EXPECT_TRUE(check_planned_motion(space, again, plan.policies).valid);
  Plan timed = plan;
  timed.motion.reset();
  EXPECT_LT(plan.motion->motion.duration(), trajectory_of(space.robot(), timed, 0.5).points.back().time);
}

/// Out and back, with that load or none, by the first seed whose motion comes with a ball that it carries on
/// its second leg within so many metres of the wall: less than 0 would touch it.
Plan out_and_close_back(const ConfigurationSpace& space, const std::vector<LegLoad>& loads, double nearer) {
  for (std::uint64_t seed = 1; seed < 50; ++seed) {
    auto query = out_and_back(space, loads);
    query.seed = seed;
    Plan plan = plan_and_check(query);
    plan.motion = plan_motion(space, plan, {}, loads.empty() ? 0.0 : 0.5);
    if (least_gap(*plan.motion, 1, 0.2) < nearer) return plan;
  }
  throw std::runtime_error("no motion comes so near");
}

/// What a motion may not do with a load, one by one.
TEST(PlannedMotion, WithALoadIsRefusedForWhatItsRobotCarriesAndNotForWhatItsPlanSays) {
  const ConfigurationSpace space = walled_space();
  const Plan plan = out_and_close_back(space, {ball_on({1})}, 0.05);
  const std::map<std::string, Policy> policies = plan.policies;
  ASSERT_TRUE(check_planned_motion(space, plan, policies).valid);
  const auto fault = [&](const Plan& changed) {
    return check_planned_motion(space, changed, policies).fault;
  };
  Plan bare = out_and_close_back(space, {}, 0.0);
  bare.loads = plan.loads;
  bare.motion->grip_time = 0.0;
  EXPECT_NE(fault(bare).find("ball"), std::string::npos) << fault(bare);  // planned without
  Plan larger = plan;
  larger.loads = {ball_on({1}, 0.25)};
  EXPECT_NE(fault(larger).find("ball"), std::string::npos) << fault(larger);
  Plan earlier = plan;
  earlier.loads = {ball_on({0, 1})};
  EXPECT_FALSE(check_planned_motion(space, earlier, policies).valid);
  Plan longer = plan;
  longer.motion->grip_time = 0.6;
  EXPECT_NE(fault(longer).find("after leg 1 it does not rest for 0.6 s"), std::string::npos) << fault(longer);
  Plan moving = plan;  // while the load is taken
  Motion& motion = moving.motion->motion;
  const std::size_t knot = plan.motion->leg_ends[0] + 30;
  for (const int off : {-1, 0, 1})
    motion.positions[knot + static_cast<std::size_t>(off + 1)] += at(0.0, off == 0 ? 4e-8 : 1e-8);
  motion.accelerations = hermite_accelerations(motion);
  EXPECT_NE(fault(moving).find("does not rest"), std::string::npos) << fault(moving);
}

/// Whole periods at rest where a load begins or ends to ride, and nothing else differs.
TEST(PlannedMotion, RestsWhereLoadsAreTakenAndLeft) {
  const ConfigurationSpace space = walled_space();
  const PlanQuery query = out_and_back(space, {ball_on({1}, 0.05)});
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

/// A panda with nothing near it, and two configurations.
struct FreePanda {
  Robot robot = load_robot("panda");
  ConfigurationSpace space{robot, VoxelScene{0.05, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)}, {}, {}}.snapshot(),
                           anywhere_but_occupied()};
  Configuration from = (Configuration(7) << 0, -0.5, 0, -2.0, 0, 1.6, 0).finished();
  Configuration to = (Configuration(7) << 1.2, 0.2, 0.3, -1.2, 0.4, 2.2, 0.5).finished();
};

TEST(PlannedMotion, ThatTorquesForbidIsNoneAndSaysSo) {
  const FreePanda free;
  const auto& [robot, space, from, to] = free;
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

/// A load's mass counts while it rides: in the motion as made, and in the judgement of another.
TEST(PlannedMotion, BearsTheWeightOfItsLoadsWhereTheyRide) {
  const FreePanda free;
  const auto& [robot, space, from, to] = free;
  LegLoad brick;
  brick.load.name = "brick";
  brick.load.link = robot.links[static_cast<std::size_t>(robot.tip_link)].name;
  brick.load.link_from_load.translation() << 0.0, 0.0, 0.16;
  brick.load.shape = Shape::box({0.04, 0.04, 0.04});
  brick.load.mass = 3.0;
  brick.load.touches = {"panda_leftfinger", "panda_rightfinger", "panda_hand"};
  std::erase_if(brick.load.touches, [&](const std::string& name) {
    return std::none_of(robot.links.begin(), robot.links.end(),
                        [&](const Link& link) { return link.name == name; });
  });
  brick.legs = {1};
  Plan plan = plan_and_check(
      {.space = space, .start = from, .goals = {to, from}, .loads = {brick}, .survey = std::nullopt});
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  give_motion(space, plan, {}, 0.2);
  ASSERT_TRUE(plan.motion) << plan.motion_caveat;
  const MotionTerms terms{robot, space.map(), plan.policies, plan.padding, 0.0, {}};
  const auto share = [&](double mass) {
    Plan stated = plan;
    stated.loads.front().load.mass = mass;
    const MotionJudgement judged = judge_motion(terms, stated);
    EXPECT_EQ(judged.verdict.valid, judged.torques->share <= 1.0 + 1e-6) << judged.verdict.fault;
    return *judged.torques;
  };
  EXPECT_LT(share(0.0).share, share(3.0).share);
  const TorqueFinding crushed = share(60.0);
  EXPECT_GT(crushed.share, 1.0);
  EXPECT_GE(crushed.place, static_cast<double>(plan.motion->leg_ends[0]));  // not before it is taken
  // By joint_torques, which the check does not use.
  const Robot loaded = robot_of_leg(robot, plan.loads, 1);
  const TorqueTerms torques = torque_terms(loaded);
  const Motion& motion = plan.motion->motion;
  double greatest = 0.0;
  for (std::size_t k = plan.motion->leg_ends[0]; k < motion.positions.size(); ++k)
    greatest = std::max(greatest, joint_torques(loaded, motion.positions[k], motion.velocities[k],
                                                motion.accelerations[k], torques)
                                      .cwiseAbs()
                                      .cwiseQuotient(torques.limits)
                                      .maxCoeff());
  EXPECT_NEAR(share(3.0).share, greatest, 1e-6);
}

/// The greatest torque is on the second leg, which follows the first without a rest for a load.
TEST(PlannedMotion, BearsItsWeightOnEachOfItsLegs) {
  const FreePanda free;
  const auto& [robot, space, from, to] = free;
  Plan plan = plan_and_check(
      {.space = space, .start = from, .goals = {from + 0.2 * (to - from), to}, .survey = std::nullopt});
  give_motion(space, plan);
  ASSERT_TRUE(plan.motion) << plan.motion_caveat;
  const MotionJudgement judged =
      judge_motion({robot, space.map(), plan.policies, plan.padding, 0.0, {}}, plan);
  const TorqueTerms torques = torque_terms(robot);
  const Motion& motion = plan.motion->motion;
  std::vector<double> shares;
  for (std::size_t k = 0; k < motion.positions.size(); ++k)
    shares.push_back(
        joint_torques(robot, motion.positions[k], motion.velocities[k], motion.accelerations[k], torques)
            .cwiseAbs()
            .cwiseQuotient(torques.limits)
            .maxCoeff());
  const auto greatest = std::max_element(shares.begin(), shares.end());
  ASSERT_GT(greatest - shares.begin(), static_cast<std::ptrdiff_t>(plan.motion->leg_ends[0]));
  EXPECT_NEAR(judged.torques->share, *greatest, 1e-6);
}

/// One after the other, the robot at rest until both are.
TEST(PlannedMotion, LoadsThatAreTakenAtOneStopHaveATimeOfTheirOwn) {
  const ConfigurationSpace space = walled_space();
  LegLoad other = ball_on({1}, 0.05);
  other.load.name = "other";
  other.load.link_from_load.translation().y() = 0.1;
  Plan plan = plan_and_check(out_and_back(space, {ball_on({1}, 0.05), other}));
  give_motion(space, plan, {}, 0.5);
  ASSERT_TRUE(plan.motion) << plan.motion_caveat;
  const Trajectory motion = trajectory_of(space.robot(), plan);
  ASSERT_EQ(motion.events.size(), 4U);
  for (const std::size_t first : {0U, 2U}) {
    const TrajectoryEvent &one = motion.events[first], &next = motion.events[first + 1];
    EXPECT_NE(one.load, next.load);
    EXPECT_NEAR(next.time, one.time + one.rest, 1e-9);
    EXPECT_GE(next.rest, 0.5);
    EXPECT_EQ(plan.motion->motion.at(next.time + next.rest - 1e-6).position,
              first == 0 ? at(2, 0) : at(0, 0.5));
  }
}

TEST(PlannedMotion, OfAPlanThatIsNotProvedIsRefused) {
  const ConfigurationSpace space = walled_space();
  Plan plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(1, 0)}});
  EXPECT_THROW(plan_motion(space, plan), std::invalid_argument);
  plan = plan_and_check({.space = space, .start = at(0, 0), .goals = {at(0, 0.5)}});
  for (const double seconds : {-0.1, 60.1, std::nan("")})
    EXPECT_THROW(plan_motion(space, plan, {}, seconds), std::invalid_argument) << seconds;
}

}  // namespace planned_motion_test
}  // namespace clearway
