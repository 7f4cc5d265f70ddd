#include "apps/suites/suite_teams.hpp"

#include <gtest/gtest.h>

#include "planning/team/team_check.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace suite_teams_test {

SuiteGenerator crossings(int count, std::uint64_t seed = 1) { return {"crossings", count, seed, 0.05}; }

TEST(SuiteTeams, CrossingsAreTheSameWhateverTheCountAndDifferBySeed) {
  const SuiteTeam one = draw_crossing(crossings(5), 3), same = draw_crossing(crossings(5000), 3),
                  other = draw_crossing(crossings(5, 2), 3);
  ASSERT_EQ(one.robots.size(), same.robots.size());
  for (std::size_t i = 0; i < one.robots.size(); ++i) {
    EXPECT_EQ(one.robots[i].start, same.robots[i].start);
    EXPECT_EQ(one.robots[i].goal, same.robots[i].goal);
  }
  EXPECT_NE(one.robots[0].start, other.robots[0].start);
}

TEST(SuiteTeams, CrossingsStartAndEndApart) {
  for (std::size_t i = 0; i < 8; ++i) {
    const SuiteTeam given = draw_crossing(crossings(8), i);
    const Team team = make_team(given, empty_map(), {});
    EXPECT_GE(team.robots.size(), 2U);
    EXPECT_LE(team.robots.size(), 5U);
    for (const bool at_goal : {false, true}) {
      TeamRun standing;
      standing.period = 0.02;
      for (const TeamRobot& robot : team.robots)
        standing.traces.emplace_back().positions = {at_goal ? robot.goal : robot.start};
      Team alone = team;
      if (at_goal) alone.obstacles.clear();
      const TeamVerdict verdict = check_team(alone, standing, 5.0, 0.5);
      EXPECT_TRUE(verdict.is_apart) << i << verdict.contact;
      EXPECT_GE(verdict.least_separation, 0.08 - 2e-4) << i << verdict.between;
    }
  }
}

TEST(SuiteTeams, RandomTeamsKeepTheSecurityDistanceByTheIndependentCheck) {
  // The same as `clearway compare datasets/suites/safety.yaml`, which has 1,400 of them.
  int counted = 0;
  const int teams = trials(7, 14);
  for (std::size_t i = 0; i < static_cast<std::size_t>(teams); ++i) {
    const Team team = make_team(draw_crossing(crossings(14), i), empty_map(), {});
    TeamOptions options;
    options.duration = 10.0;
    const TeamRun run = run_team(team, options);
    const TeamVerdict verdict =
        check_team(team, run, options.max_acceleration, run.figures.influence_distance);
    if (!run.outrun.empty()) continue;
    ++counted;
    EXPECT_TRUE(verdict.is_apart) << i << verdict.between << verdict.contact;
    EXPECT_GE(verdict.least_separation, run.figures.security_distance - run.step_bound()) << i;
    EXPECT_LE(verdict.greatest_speed_share, 1.0 + 1e-9) << i;
  }
  EXPECT_GE(counted, teams / 2);
}

TEST(SuiteTeams, ATeamThatDoesNotFitItsRobotsIsRefusedWithTeamAndRobot) {
  SuiteTeam team;
  team.name = "pair";
  team.robots.push_back({"left", "arm5", {}, 0.0, {}, {0.0, 0.0}, {0.0, 0.0}});
  try {
    make_team(team, empty_map(), {});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "team 'pair', robot 'left': start and goal: got 2 and 2 values, expected 5 each (robot 'arm5')");
  }
}

}  // namespace suite_teams_test
}  // namespace clearway
