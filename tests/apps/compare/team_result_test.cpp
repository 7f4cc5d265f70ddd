#include "apps/compare/team_result.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "apps/suites/suite_teams.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace team_result_test {

/// A run of no robot but with one trace of two positions, which kept its distances.
TeamRun short_run() {
  TeamRun run;
  run.status = PlanStatus::timed_out;
  run.period = 0.5;
  run.figures.security_distance = 0.05;
  run.figures.max_step = {0.1};
  return run;
}

/// What check_team says of a run that kept these distances, from obstacles and between robots.
TeamVerdict apart(double from_obstacles, double between_robots) {
  TeamVerdict verdict;
  verdict.least_separation = std::min(from_obstacles, between_robots);
  verdict.between_robots = between_robots;
  verdict.is_apart = verdict.least_separation > 0.0;
  verdict.robots_are_apart = between_robots > 0.0;
  return verdict;
}
TeamVerdict apart(double separation) { return apart(separation, separation); }

/// Two discs that rest for one period.
struct Resting {
  Resting() {
    for (int i = 0; i < 2; ++i) {
      TeamTrace& trace = run.traces.emplace_back();
      trace.positions = {Eigen::Vector2d(i, 0.0), Eigen::Vector2d(i, 0.0)};
      Robot disc = load_robot("point");
      team.robots.push_back({"disc",
                             std::make_shared<const ConfigurationSpace>(disc, empty_map(), Policies{}),
                             trace.positions[0], trace.positions[1]});
    }
  }
  std::string check(double separation, const TeamCircumstances& circumstances = {}) const {
    return team_result(team, run, apart(separation), circumstances).check;
  }
  Team team;
  TeamRun run = short_run();
};

TEST(TeamResult, OfARunThatTheClockEndedIsNeverValid) {
  const Resting resting;
  EXPECT_EQ(resting.check(0.06), "valid");
  EXPECT_EQ(resting.check(0.06, {.is_cut_short = true}), "unfinished");
}

TEST(TeamResult, OfARunThatCameTooNearIsRefusedWhoeverEndedIt) {
  const Resting resting;
  EXPECT_EQ(resting.check(0.04), "refused");
  EXPECT_EQ(resting.check(0.04, {.is_cut_short = true}), "refused");
}

TEST(TeamResult, DistancesAndSpeedsExactlyAtTheirLimitsAreValid) {
  const Resting resting;
  ASSERT_EQ(resting.run.step_bound(), 0.0);
  EXPECT_EQ(resting.check(0.05), "valid");
  TeamVerdict verdict = apart(0.06);
  verdict.greatest_speed_share = 1.0 + 0.9e-6;  // rounding
  EXPECT_EQ(team_result(resting.team, resting.run, verdict, {}).check, "valid");
  verdict.greatest_speed_share = 1.0 + 1.1e-6;
  EXPECT_EQ(team_result(resting.team, resting.run, verdict, {}).check, "refused");
}

TEST(TeamResult, GrantsWhatSensedThingsMoveUnseenToObstaclesAloneNotToRobots) {
  const Resting resting;
  const TeamVerdict from_obstacles = apart(0.04, 0.06), between_robots = apart(0.06, 0.04);
  const TeamCircumstances sensed{.unseen_motion = 0.02};
  EXPECT_EQ(team_result(resting.team, resting.run, from_obstacles, {}).check, "refused");
  EXPECT_EQ(team_result(resting.team, resting.run, from_obstacles, sensed).check, "valid");
  EXPECT_EQ(team_result(resting.team, resting.run, between_robots, sensed).check, "refused");
}

TEST(TeamResult, ContactIsNeverSafeHoweverLongAStepAndHoweverSmallTheSecurityDistance) {
  Resting resting;
  for (TeamTrace& trace : resting.run.traces) trace.greatest_motion = 1.0;  // d_s is 5 cm
  ASSERT_GT(resting.run.step_bound(), resting.run.figures.security_distance);
  const TeamCircumstances sensed{.unseen_motion = 1.0};
  EXPECT_EQ(resting.check(1e-3, sensed), "valid");
  for (const TeamVerdict& touching : {apart(0.0, 0.06), apart(0.06, 0.0), apart(0.0)})
    EXPECT_EQ(team_result(resting.team, resting.run, touching, sensed).check, "refused");
}

TEST(TeamResult, DiscsThatPassThroughEachOtherBetweenTwoStepsAreRefused) {
  Resting resting;
  resting.team.robots[1].name = "other";
  resting.run.traces[0].positions = {Eigen::Vector2d(-2.0, 0.0), Eigen::Vector2d(2.0, 0.0)};
  resting.run.traces[1].positions = {Eigen::Vector2d(2.0, 0.0), Eigen::Vector2d(-2.0, 0.0)};
  for (TeamTrace& trace : resting.run.traces) trace.greatest_motion = 4.0;
  resting.run.period = 10.0;
  const TeamVerdict verdict = check_team(resting.team, resting.run, 5.0, 1.0);
  EXPECT_EQ(verdict.least_separation, 0.0);
  EXPECT_EQ(verdict.between_robots, 0.0);
  EXPECT_FALSE(verdict.is_apart || verdict.robots_are_apart);
  EXPECT_EQ(team_result(resting.team, resting.run, verdict, {}).check, "refused");
}

TEST(TeamResult, CallsOutrunWhatIsNotRefusedForOtherReasons) {
  Resting resting;
  resting.run.outrun = "At 1 s robot 'disc' could not …";
  EXPECT_EQ(team_result(resting.team, resting.run, apart(0.0, 0.06), {}).check, "outrun");
  EXPECT_EQ(team_result(resting.team, resting.run, apart(0.0), {}).check, "refused");
  TeamVerdict verdict = apart(0.06);
  verdict.greatest_speed_share = 1.01;
  EXPECT_EQ(team_result(resting.team, resting.run, verdict, {}).check, "refused");
}

TEST(TeamResult, NamesTheFirstContactElseWhatCameTooNear) {
  const Resting resting;
  const auto contact = [&](const TeamVerdict& verdict) {
    return team_result(resting.team, resting.run, verdict, {}).contact;
  };
  TeamVerdict verdict = apart(0.0125);
  verdict.between = "left/load and right/forearm";
  verdict.time = 1.2344;
  EXPECT_EQ(contact(verdict), "left/load and right/forearm came within 12.5 mm at 1.234 s");
  verdict.contact = "left: load touches an occupied voxel";
  verdict.is_apart = verdict.robots_are_apart = false;
  EXPECT_EQ(contact(verdict), "left: load touches an occupied voxel");
  EXPECT_EQ(contact(apart(0.06)), "") << "nothing to report of a run that is valid";
}

TEST(TeamResult, ReportsTheDistancesThatItsVerdictWasMadeWith) {
  Resting resting;
  for (TeamTrace& trace : resting.run.traces) trace.greatest_motion = 0.01;
  resting.run.traces[1].positions.back() += Eigen::Vector2d(0.3, 0.4);
  resting.run.figures.greatest_obstacle_speed = 0.25;
  resting.run.outrun = "At 1 s robot 'disc' could not …";
  TeamVerdict verdict = apart(0.06);
  verdict.between_robots = 0.07;
  verdict.greatest_speed_share = 0.5;
  const CompareRun found = team_result(resting.team, resting.run, verdict, {.unseen_motion = 0.02});
  ASSERT_TRUE(found.team.has_value());
  EXPECT_EQ(found.team->security_distance, 0.05);
  EXPECT_GE(resting.run.step_bound(), 0.01);
  EXPECT_DOUBLE_EQ(found.team->step_bound, resting.run.step_bound() + 0.02);
  EXPECT_EQ(found.team->obstacle_speed, 0.25);
  EXPECT_EQ(found.team->between_robots, 0.07);
  EXPECT_EQ(found.team->outrun, resting.run.outrun);
  EXPECT_EQ(found.min_clearance, 0.06);
  EXPECT_DOUBLE_EQ(found.length, 0.5);
  EXPECT_EQ(found.steps, 1U);
  EXPECT_EQ(found.waypoints, 2U);
  ASSERT_TRUE(found.motion.has_value());
  EXPECT_EQ(found.motion->time, 0.5);
  EXPECT_EQ(found.motion->speed, 0.5);
  EXPECT_EQ(found.legs, 0U);
  resting.run.status = PlanStatus::solved;
  EXPECT_EQ(team_result(resting.team, resting.run, verdict, {}).legs, 1U);
}

TEST(TeamResult, CostsWhatThePayloadsAndGravityMakeOfTheWay) {
  Resting resting;
  resting.run.traces[1].positions.back() = Eigen::Vector2d(1.0, 1.0);
  const auto cost = [&](const TeamCircumstances& circumstances) {
    return team_result(resting.team, resting.run, apart(0.06), circumstances).cost;
  };
  const Eigen::Vector3d along(0.0, -9.81, 0.0);
  EXPECT_GT(cost({.gravity = along}), cost({}));
  EXPECT_GT(cost({.payloads = {0.0, 2.0}, .gravity = along}),
            cost({.payloads = {2.0, 0.0}, .gravity = along}));
  EXPECT_EQ(cost({.payloads = {2.0, 0.0}, .gravity = along}), cost({.gravity = along}))
      << "the first one rests";
}

TEST(TeamResult, IsAsLongAsTheWaysOfAllRobots) {
  Resting resting;
  for (TeamTrace& trace : resting.run.traces)
    trace.positions.back() = trace.positions.front() + Eigen::Vector2d(0.3, 0.4);
  EXPECT_NEAR(team_result(resting.team, resting.run, apart(0.06), {}).length,
              0.5 * static_cast<double>(resting.run.traces.size()), 1e-12);
}

TEST(TeamResult, OfARunWithoutAStepHasNothingToCheck) {
  Resting resting;
  for (TeamTrace& trace : resting.run.traces) trace.positions.pop_back();
  EXPECT_EQ(resting.check(0.06), "none");
}

}  // namespace team_result_test
}  // namespace clearway
