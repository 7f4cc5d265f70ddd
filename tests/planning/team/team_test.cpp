#include "planning/team/team.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "planning/robot_files/load_robot.hpp"
#include "planning/team/team_check.hpp"
#include "planning/team/team_member.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace team_test {

TeamRobot robot_at(const std::string& name, const std::string& kind, double x, double y, double yaw,
                   const Configuration& start, const Configuration& goal, const VoxelScene& scene = {}) {
  Robot robot = load_robot(kind);
  robot.map_from_base = Eigen::Translation3d(x, y, 0.0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
  Policies policies;
  policies.critical_by_default = false;
  return {name, std::make_shared<const ConfigurationSpace>(robot, scene.snapshot(), policies), start, goal};
}

Configuration values(std::initializer_list<double> list) {
  Configuration q(static_cast<Eigen::Index>(list.size()));
  std::copy(list.begin(), list.end(), q.begin());
  return q;
}

/// Fig. 13: face to face, loads swing across the middle.
Team two_arms() {
  const Configuration start = values({-0.6, -0.3, 0.6, -0.3, 0.0}),
                      goal = values({0.6, -0.3, 0.6, -0.3, 0.0});
  return {{robot_at("left", "arm5", 0.0, 0.0, 0.0, start, goal),
           robot_at("right", "arm5", 1.2, 0.0, std::numbers::pi, start, goal)},
          {}};
}

/// Fig. 14: in a ring, reaching over its middle.
Team three_pumas() {
  Team team;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 3.0;
    team.robots.push_back(robot_at("puma" + std::to_string(i), "puma560", 0.6 * std::cos(angle),
                                   0.6 * std::sin(angle), angle + std::numbers::pi,
                                   values({-1.0, -0.5, -0.6, 0.0, 0.4, 0.0}),
                                   values({1.0, -0.5, -0.6, 0.0, 0.4, 0.0})));
  }
  return team;
}

TeamOptions options(bool follows, bool upper = true) {
  TeamOptions chosen;
  chosen.follows_boundaries = follows;
  chosen.boundary.side = upper ? BoundarySide::upper : BoundarySide::lower;
  chosen.duration = 40.0;
  return chosen;
}

/// What every run promises, by the independent check.
void expect_safe(const Team& team, const TeamRun& run, const TeamOptions& chosen) {
  const TeamVerdict verdict = check_team(team, run, chosen.max_acceleration, run.figures.influence_distance);
  EXPECT_TRUE(verdict.is_apart) << verdict.between << verdict.contact;
  EXPECT_GE(verdict.least_separation, run.figures.security_distance - run.step_bound());
  EXPECT_LE(verdict.least_separation, run.least_separation() + 1e-6);
  EXPECT_LE(verdict.greatest_speed_share, 1.0 + 1e-9);
  EXPECT_LE(verdict.greatest_acceleration_share, 1.0 + 1e-6);
  EXPECT_EQ(run.outrun, "");
}

void expect_figure(const Team& team) {
  const TeamOptions local = options(false);
  const TeamRun stuck = run_team(team, local);
  EXPECT_EQ(stuck.status, PlanStatus::no_path) << stuck.explanation;
  expect_safe(team, stuck, local);
  for (const bool upper : {true, false}) {
    const TeamOptions chosen = options(true, upper);
    const TeamRun run = run_team(team, chosen);
    ASSERT_EQ(run.status, PlanStatus::solved) << run.explanation;
    for (std::size_t i = 0; i < team.robots.size(); ++i) {
      EXPECT_EQ(run.traces[i].positions.front(), team.robots[i].start);
      EXPECT_EQ(run.traces[i].positions.back(), team.robots[i].goal);
      EXPECT_GE(run.traces[i].deadlocks, 1);
    }
    expect_safe(team, run, chosen);
  }
}

TEST(Team, Figure13TwoArmsPassEachOtherAlongTheirBoundaries) { expect_figure(two_arms()); }

TEST(Team, Figure14ThreePumas) { expect_figure(three_pumas()); }

TEST(Team, TheSameRunTwice) {
  const Team team = two_arms();
  const TeamRun first = run_team(team, options(true)), second = run_team(team, options(true));
  ASSERT_EQ(first.steps(), second.steps());
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k <= first.steps(); ++k)
      EXPECT_EQ(first.traces[i].positions[k], second.traces[i].positions[k]);
}

MovingObstacle ball_along(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double speed) {
  Eigen::Isometry3d a = Eigen::Isometry3d::Identity(), b = a;
  a.translation() = from;
  b.translation() = to;
  return {"ball", Shape::sphere(0.1), RigidMotion({{0.0, a}, {(to - from).norm() / speed, b}})};
}

TEST(Team, AnArmGivesWayToABallThatComesSlowly) {
  const Configuration rest = values({0.0, -0.3, 0.6, -0.3, 0.0});
  Team team{{robot_at("arm", "arm5", 0.0, 0.0, 0.0, rest, rest)},
            {ball_along({0.95, 1.5, 0.45}, {0.95, -1.5, 0.45}, 0.15)}};
  TeamOptions chosen = options(false);
  const TeamRun run = run_team(team, chosen);
  expect_safe(team, run, chosen);
  double most = 0.0;
  for (const Configuration& q : run.traces[0].positions) most = std::max(most, (q - rest).norm());
  EXPECT_GT(most, 0.1);                                          // it stood in the way and made room
  EXPECT_EQ(run.status, PlanStatus::solved) << run.explanation;  // and came back
}

TEST(Team, ABallThatOutrunsTheArmIsReportedAsSuch) {
  const Configuration rest = values({0.0, -0.3, 0.6, -0.3, 0.0});
  const Team fast{{robot_at("arm", "arm5", 0.0, 0.0, 0.0, rest, rest)},
                  {ball_along({0.8, 3.0, 0.45}, {0.8, -3.0, 0.45}, 6.0)}};
  TeamOptions chosen = options(false);
  chosen.duration = 3.0;
  const TeamRun hit = run_team(fast, chosen);
  EXPECT_NE(hit.outrun.find("ball"), std::string::npos) << hit.explanation;
  // Into the shoulder, which no joint moves away.
  const Team rammed{{robot_at("arm", "arm5", 0.0, 0.0, 0.0, rest, rest)},
                    {ball_along({-1.0, 0.0, 0.45}, {0.0, 0.0, 0.45}, 0.5)}};
  EXPECT_NE(run_team(rammed, chosen).outrun, "");
  // Into the pedestal, which nothing moves.
  const Team pedestal{{robot_at("arm", "arm5", 0.0, 0.0, 0.0, rest, rest)},
                      {ball_along({-1.0, 0.0, 0.2}, {0.0, 0.0, 0.2}, 0.5)}};
  const TeamRun through = run_team(pedestal, chosen);
  EXPECT_NE(through.outrun, "");
  EXPECT_FALSE(check_team(pedestal, through, 5.0, 0.5).is_apart);
  EXPECT_TRUE(check_team(pedestal, through, 5.0, 0.5).robots_are_apart);
}

TEST(Team, AMapThatIsSensedAnewStopsTheRobot) {
  // A wall appears half-way, one second after the start: the disc was heading right through it.
  const VoxelScene wall{0.05, {box_of(2.0, -1.0, -0.05, 2.1, 1.0, 0.05)}, {}, {}};
  const Configuration start = Eigen::Vector2d(0.0, 0.0), goal = Eigen::Vector2d(4.0, 0.0);
  Team team{{robot_at("disc", "point", 0.0, 0.0, 0.0, start, goal)}, {}};
  const TeamRobot later = robot_at("disc", "point", 0.0, 0.0, 0.0, start, goal, wall);
  EXPECT_EQ(run_team(team, options(false)).status, PlanStatus::solved);
  team.sensed = [&](std::size_t, double time) {
    return time >= 1.0 ? later.space : std::shared_ptr<const ConfigurationSpace>();
  };
  const TeamRun stopped = run_team(team, options(false));
  EXPECT_NE(stopped.status, PlanStatus::solved);
  EXPECT_LT(stopped.traces[0].positions.back()[0], 1.8);
  EXPECT_GT(stopped.traces[0].positions.back()[0], 1.6);
  const TeamRun round = run_team(team, options(true));
  EXPECT_EQ(round.status, PlanStatus::solved) << round.explanation;
}

TEST(Team, WallsThatWereKnownAreNoExcuseWhileSensorsLook) {
  // A disc of 0.2 m between walls 5 cm away on either side, of which 6 cm are demanded.
  const Eigen::AlignedBox3d left = box_of(-1.0, 0.25, -0.05, 1.0, 0.35, 0.05),
                            right = box_of(-1.0, -0.35, -0.05, 1.0, -0.25, 0.05);
  const VoxelScene one{0.05, {left}, {}, {}}, both{0.05, {left, right}, {}, {}};
  const Configuration start = Eigen::Vector2d(0.0, 0.0), goal = Eigen::Vector2d(0.5, 0.0);
  const auto disc_in = [&](const VoxelScene& scene) {
    return robot_at("disc", "point", 0.0, 0.0, 0.0, start, goal, scene);
  };
  TeamOptions chosen = options(false);
  chosen.boundary.local.influence_distance = 0.2;
  chosen.boundary.local.security_distance = 0.06;
  chosen.duration = 2.0;
  const TeamRobot later = disc_in(both);
  const SensedSpace sensed = [&](std::size_t, double) { return later.space; };
  const TeamRun known = run_team({{disc_in(both)}, {}, sensed}, chosen);
  EXPECT_GT(known.traces[0].relaxed, 0);
  EXPECT_EQ(known.outrun, "");
  const TeamRun anew = run_team({{disc_in(one)}, {}, sensed}, chosen);
  EXPECT_GT(anew.traces[0].relaxed, 0);
  EXPECT_NE(anew.outrun.find("what sensors saw"), std::string::npos) << anew.outrun;
}

TEST(Team, InvalidEndsAreReportedWithRobotAndBody) {
  Team team = two_arms();
  team.robots[1].start = values({0.0, 0.5, 0.0, 0.0, 0.0});
  team.robots[0].start = values({0.0, 0.5, 0.0, 0.0, 0.0});
  const TeamRun contact = run_team(team, options(true));
  EXPECT_EQ(contact.status, PlanStatus::start_invalid);
  EXPECT_NE(contact.explanation.find("Robot 'left' at its start: "), std::string::npos)
      << contact.explanation;
  EXPECT_NE(contact.explanation.find("right/"), std::string::npos) << contact.explanation;
  // One in the other's pedestal, and a ball in a pedestal: what no joint moves counts, too.
  Team close = two_arms();
  close.robots[1] = robot_at("right", "arm5", 0.05, 0.0, 0.0, close.robots[1].start, close.robots[1].goal);
  EXPECT_EQ(run_team(close, options(true)).status, PlanStatus::start_invalid);
  Team ball = two_arms();
  ball.obstacles.push_back(ball_along({0.0, 0.0, 0.2}, {0.0, 0.0, 3.0}, 0.5));
  EXPECT_EQ(run_team(ball, options(true)).status, PlanStatus::start_invalid);
  team = two_arms();
  team.robots[0].goal[0] = 4.0;
  EXPECT_EQ(run_team(team, options(true)).status, PlanStatus::goal_invalid);
}

/// The sentence of what run_team throws.
std::string refusal(const Team& team, const TeamOptions& chosen) {
  try {
    run_team(team, chosen);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Team, BadInputIsRefusedInOneSentence) {
  Team team = two_arms();
  team.robots[1].name = "left";
  EXPECT_EQ(refusal(team, options(true)), "two robots are called 'left': expected names that differ");
  EXPECT_EQ(refusal({}, options(true)), "a team needs at least one robot");
  TeamOptions chosen = options(true);
  chosen.boundary.local.influence_distance = 0.02;
  chosen.boundary.local.security_distance = 0.03;
  EXPECT_NE(refusal(two_arms(), chosen).find("expected security < influence"), std::string::npos);
  chosen.boundary.local.security_distance = 0.01;
  chosen.boundary.local.xi = 0.011;
  EXPECT_NE(refusal(two_arms(), chosen).find("xi 0.011: expected xi <= influence - security"),
            std::string::npos);
  const auto refused = [](const auto& spoil) {
    TeamOptions spoilt = options(true);
    spoil(spoilt);
    return refusal(two_arms(), spoilt);
  };
  EXPECT_NE(refused([](TeamOptions& o) { o.boundary.local.max_step = -1.0; }).find("team: option 'max_step'"),
            std::string::npos);
  EXPECT_NE(refused([](TeamOptions& o) { o.boundary.leave_ratio = NAN; }).find("team: option 'leave_ratio'"),
            std::string::npos);
  EXPECT_NE(refused([](TeamOptions& o) { o.max_acceleration = INFINITY; }).find("max_acceleration"),
            std::string::npos);
  team = two_arms();
  Robot still = team.robots[0].space->robot();
  still.joints[2].max_velocity = 0.0;
  team.robots[0].space = std::make_shared<const ConfigurationSpace>(still, VoxelScene{}.snapshot());
  EXPECT_NE(refusal(team, options(true)).find("robot 'left', joint 'elbow_pitch': its velocity limit is 0"),
            std::string::npos);
  EXPECT_THROW(team_options("beam", {}), std::invalid_argument);
  EXPECT_THROW(team_options("boundary", {{"side", "left"}}), std::invalid_argument);
  EXPECT_THROW(team_options("boundary", {{"max_steps", "9"}}), std::invalid_argument);
  EXPECT_FALSE(team_options("constraint", {}).follows_boundaries);
}

TEST(Team, AHugeInfluenceDistanceDemandsNoMoreThanTheRobotsHaveAtTheirEnds) {
  TeamOptions chosen = options(false);
  chosen.boundary.local.influence_distance = 1000.0;
  chosen.duration = 0.5;
  const TeamRun run = run_team(two_arms(), chosen);
  ASSERT_FALSE(run.traces.empty());
  for (const TeamTrace& trace : run.traces)
    EXPECT_LT(run.figures.security_distance, trace.separations.front());
}

TEST(Team, BrakingStepsEndWithinTheRoomAndNoLongerOnesDo) {
  const auto way = [](double step, double change) {
    double sum = 0.0;
    for (; step > 0.0; step -= change) sum += step;
    return sum;
  };
  for (const double change : {1e-3, 0.02}) {
    for (double room = 1e-5; room < 1.0; room *= 1.37) {
      const double step = braking_step(room, change);
      EXPECT_LE(way(step, change), room * (1.0 + 1e-9));
      EXPECT_GT(way(step * 1.001 + 1e-9, change), room);
    }
  }
}

}  // namespace team_test
}  // namespace clearway
