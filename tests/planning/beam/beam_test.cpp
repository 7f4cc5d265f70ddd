#include "planning/beam/beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "planning/beam/beam_search.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/beam_world.hpp"

namespace clearway {
namespace beam_test {

constexpr double kDegree = std::numbers::pi / 180.0;

void expect_valid(const BeamWorld& world, const PlanResult& result, const Configuration& start) {
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  EXPECT_EQ(result.waypoints.front(), start);
  for (std::size_t i = 1; i < result.waypoints.size(); ++i) {
    EXPECT_TRUE(world.space.is_edge_free(result.waypoints[i - 1], result.waypoints[i])) << i;
  }
}

/// Occupied blocks of random size and place around the robot; through the plane z = 0 when it is `flat`.
VoxelScene random_scene(std::mt19937_64& random, double size, double resolution, int blocks, bool flat) {
  std::uniform_real_distribution<double> place(-size, size), extent(0.02 * size, 0.15 * size);
  VoxelScene scene;
  scene.resolution = resolution;
  for (int i = 0; i < blocks; ++i) {
    Eigen::AlignedBox3d box;
    box.min() = Eigen::Vector3d(place(random), place(random), 0.5 * place(random));
    box.max() = box.min() + Eigen::Vector3d(extent(random), extent(random), extent(random));
    if (flat) box.min().z() = -resolution, box.max().z() = resolution;
    scene.occupied.push_back(box);
  }
  return scene;
}

struct Family {
  const char* robot;
  double size, resolution, step, reach;  ///< of the scene (m); steps and goal offsets in rad or m
  int blocks, scenes, queries, widest;
};

class BeamAgainstReference : public testing::TestWithParam<Family> {};

TEST_P(BeamAgainstReference, GivesTheSamePathCostAndStepsBitForBit) {
  const Family family = GetParam();
  const Robot robot = load_robot(family.robot);
  const auto n = static_cast<Eigen::Index>(robot.dof());
  std::mt19937_64 random(20 + static_cast<unsigned>(n));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int solved = 0, failed = 0;
  for (int s = 0; s < family.scenes; ++s) {
    const BeamWorld world(robot, random_scene(random, family.size, family.resolution, family.blocks, n == 2));
    for (int i = 0; i < family.queries; ++i) {
      const Configuration start =
          Configuration::NullaryExpr(n, [&] { return family.reach * 3.0 * uniform(random); });
      const Configuration goal =
          start + Configuration::NullaryExpr(n, [&] { return family.reach * uniform(random); });
      const int width = 1 + static_cast<int>(random() % static_cast<unsigned>(family.widest));
      const PlannerOptions options = {{"width", std::to_string(width)},
                                      {"step", std::to_string(family.step)},
                                      {"max_steps", std::to_string(3 + random() % 23)},
                                      {"node_only", i % 8 == 7 ? "true" : "false"}};
      const PlanResult fast = world.plan("beam", start, goal, options);
      if (fast.status == PlanStatus::start_invalid || fast.status == PlanStatus::goal_invalid) continue;
      ++(fast.status == PlanStatus::solved ? solved : failed);
      const PlanResult slow = world.plan("beam_reference", start, goal, options);
      expect_equal(fast, slow,
                   std::string(family.robot) + " scene " + std::to_string(s) + " query " + std::to_string(i));
      EXPECT_LE(fast.configurations_checked, slow.configurations_checked);
    }
  }
  EXPECT_GT(solved, 0);
  RecordProperty("solved", solved);
  RecordProperty("failed", failed);
}

INSTANTIATE_TEST_SUITE_P(Robots, BeamAgainstReference,
                         testing::Values(Family{"point", 2.0, 0.1, 0.1, 1.0, 30, 12, 40, 20},
                                         Family{"planar2", 2.0, 0.1, 0.1, 0.8, 8, 12, 40, 20},
                                         Family{"arm5", 0.9, 0.05, 0.09, 0.5, 16, 4, 6, 8},
                                         Family{"puma560", 0.9, 0.05, 0.1, 0.4, 16, 4, 5, 4}),
                         [](const auto& family) { return std::string(family.param.robot); });

TEST(Beam, TiesAreBrokenTheSameWayInBoth) {
  // Start, goal and steps on a grid: many nodes at exactly equal distances.
  VoxelScene scene{0.1, {box_of(0.35, -0.35, -0.1, 0.55, 0.35, 0.1)}, {}, {}};
  const BeamWorld world(load_robot("point"), scene);
  for (int width = 1; width <= 20; ++width) {
    const PlannerOptions options = {{"width", std::to_string(width)}, {"step", "0.125"}};
    const PlanResult fast = world.plan("beam", vector_of({0.0, 0.0}), vector_of({1.0, 0.0}), options);
    expect_equal(fast, world.plan("beam_reference", vector_of({0.0, 0.0}), vector_of({1.0, 0.0}), options),
                 std::to_string(width));
    expect_equal(fast, world.plan("beam", vector_of({0.0, 0.0}), vector_of({1.0, 0.0}), options), "again");
  }
}

/// Steps, slopes and flats of one joint's profile, in steps of epsilon.
void expect_ramp_then_flat(const PlanResult& result, double step) {
  const std::size_t steps = static_cast<std::size_t>(result.search_steps);
  for (Eigen::Index j = 0; j < result.waypoints[0].size(); ++j) {
    bool is_flat = false;
    double slope = 0.0;
    for (std::size_t t = 0; t < steps; ++t) {
      const double change = (result.waypoints[t + 1][j] - result.waypoints[t][j]) / step;
      if (std::abs(change) < 1e-9) {
        is_flat = true;
        continue;
      }
      EXPECT_FALSE(is_flat) << "joint " << j << " moves again at step " << t;
      EXPECT_NEAR(std::abs(change), 1.0, 1e-9);
      if (slope != 0.0) {
        EXPECT_GT(slope * change, 0.0) << "joint " << j << " turns back at step " << t;
      }
      slope = change;
    }
  }
}

void expect_scenario_1(const BeamWorld& world, const Configuration& start, const Configuration& goal) {
  const double ramp = (goal - start).cwiseAbs().maxCoeff() / (0.5 * kDegree);
  const PlanResult greedy = world.plan("beam", start, goal, {{"width", "1"}});
  expect_valid(world, greedy, start);
  EXPECT_NEAR(greedy.search_steps, ramp, 1.0);
  expect_ramp_then_flat(greedy, 0.5 * kDegree);
  EXPECT_LE(greedy.final_distance, 0.5 * kDegree * std::sqrt(6.0));
  for (const int width : {2, 5, 10, 20}) {
    const PlanResult wide = world.plan("beam", start, goal, {{"width", std::to_string(width)}});
    expect_valid(world, wide, start);
    EXPECT_EQ(wide.statistics.at("first_goal_step"), greedy.search_steps) << width;
    EXPECT_EQ(wide.search_steps, greedy.search_steps) << width;
    EXPECT_LE(wide.cost, greedy.cost) << width;
    EXPECT_GE(wide.cost, 0.98 * greedy.cost) << width;
  }
}

TEST(Beam, Scenario1InAnEmptyMapIsARampForEveryJoint) {
  // Tasks of the paper's size: about 86 steps, and the shoulder and the elbow carry the arm a good way.
  const BeamWorld world(load_robot("puma560"), VoxelScene{});
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  for (int i = 0; i < 5; ++i) {
    const Configuration start = vector_of({0.0, -0.3, 0.6, 0.0, 0.4, 0.0}) +
                                0.2 * Configuration::NullaryExpr(6, [&] { return uniform(random); });
    Configuration goal = start + Configuration::NullaryExpr(6, [&] { return uniform(random); });
    goal[1] = start[1] - 0.7, goal[2] = start[2] - 0.5;
    ASSERT_TRUE(world.space.is_free(start) && world.space.is_free(goal))
        << world.space.check(start).sentence();
    expect_scenario_1(world, start, goal);
  }
}

TEST(Beam, Scenario1InACompactPaintedVolumeOfTheMiniature) {
  const Robot robot = load_robot("puma560_miniature");
  const Configuration start = vector_of({0.0, -0.8, 0.3, 0.0, 0.4, 0.0});
  Configuration goal = start;
  goal[0] += 43.0 * kDegree, goal[1] += 20.0 * kDegree, goal[4] -= 11.3 * kDegree;
  VoxelScene scene;
  scene.resolution = 0.0025;
  scene.painted = {{tip_pose(robot, 0.5 * (start + goal)).translation(), 0.09}};
  scene.critical_parts = robot.critical_parts;
  const BeamWorld world(robot, scene, Policies{});
  ASSERT_EQ(world.space.policies().at("tool"), Policy::painted);
  expect_scenario_1(world, start, goal);
}

/// A pocket in front of the point robot, open to its side: the greedy search runs into it.
VoxelScene pocket() {
  VoxelScene scene;
  scene.resolution = 0.1;
  scene.occupied = {box_of(1.0, -0.6, -0.1, 1.1, 0.6, 0.1), box_of(0.4, 0.5, -0.1, 1.1, 0.6, 0.1),
                    box_of(0.4, -0.6, -0.1, 1.1, -0.5, 0.1)};
  return scene;
}

TEST(Beam, Scenario3AHoleStallsNarrowBeamsAndLetsWideOnesPass) {
  const BeamWorld world(load_robot("point"), pocket());
  const Configuration start = vector_of({-0.5, 0.0}), goal = vector_of({2.0, 0.05});
  for (const int width : {1, 5, 10, 20, 40}) {
    const PlanResult result = world.plan(
        "beam", start, goal, {{"width", std::to_string(width)}, {"step", "0.025"}, {"max_steps", "165"}});
    if (width >= 20) {
      expect_valid(world, result, start);
      EXPECT_EQ(result.waypoints.back(), goal);
      continue;
    }
    EXPECT_EQ(result.status, PlanStatus::no_path) << width;
    EXPECT_EQ(result.explanation.substr(0, 7), "stalled") << width;
    EXPECT_FALSE(result.explored.empty());
  }
}

TEST(Beam, ABeamThatWalkedIntoADeadEndStallsLongBeforeMaxSteps) {
  const BeamWorld world(load_robot("point"), pocket());
  const Configuration start = vector_of({-0.5, 0.0}), goal = vector_of({2.0, 0.05});
  const PlanResult result = world.plan("beam", start, goal, {{"width", "5"}, {"step", "0.1"}});
  EXPECT_EQ(result.status, PlanStatus::no_path);
  EXPECT_LT(result.search_steps, 30);
  EXPECT_NE(result.explanation.find("occupied"), std::string::npos) << result.explanation;
  EXPECT_EQ(world.plan("beam", start, goal, {{"width", "10"}, {"step", "0.1"}}).status, PlanStatus::solved);
}

TEST(Beam, AnEnclosedGoalEndsInNoPathWithTheReason) {
  VoxelScene scene;
  scene.resolution = 0.1;
  scene.occupied = {box_of(1, -1, -0.1, 1.1, 1, 0.1), box_of(2.9, -1, -0.1, 3, 1, 0.1),
                    box_of(1, -1, -0.1, 3, -0.9, 0.1), box_of(1, 0.9, -0.1, 3, 1, 0.1)};
  Robot robot = load_robot("point");
  for (Joint& joint : robot.joints) joint.lower = -4.0, joint.upper = 4.0;
  const BeamWorld world(robot, scene);
  const Configuration start = vector_of({0.0, 0.0}), goal = vector_of({2.0, 0.0});
  for (const char* width : {"1", "10", "200"}) {
    const PlanResult result = world.plan("beam", start, goal, {{"width", width}, {"step", "0.1"}});
    EXPECT_EQ(result.status, PlanStatus::no_path);
    EXPECT_EQ(result.explanation.substr(0, 7), "stalled") << result.explanation;
    EXPECT_NE(result.explanation.find("base"), std::string::npos) << result.explanation;
    EXPECT_NEAR(result.final_distance, 1.25, 0.12) << result.explanation;
    EXPECT_TRUE(result.waypoints.empty());
  }
}

TEST(Beam, NoNodeIsVisitedTwice) {
  const BeamWorld world(load_robot("point"), pocket());
  const PlanResult result =
      world.plan("beam", vector_of({0.0, 0.0}), vector_of({2.0, 0.05}), {{"width", "1"}, {"step", "0.1"}});
  // k = 1 and every head a new node: the best path has no node twice and the search ends by itself.
  for (std::size_t i = 0; i < result.explored.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(result.explored[i], result.explored[k]);
  }
  EXPECT_EQ(result.statistics.at("heads"), 1.0 + result.statistics.at("steps_searched"));
}

TEST(Beam, AStartInTheGoalBoxNeedsNoStep) {
  const BeamWorld world(load_robot("point"), VoxelScene{});
  const PlanResult near =
      world.plan("beam", vector_of({0.0, 0.0}), vector_of({0.03, -0.05}), {{"step", "0.05"}});
  expect_valid(world, near, vector_of({0.0, 0.0}));
  EXPECT_EQ(near.search_steps, 0);
  EXPECT_EQ(near.cost, 0.0);
  EXPECT_TRUE(near.last_segment);
  EXPECT_GT(near.last_segment_cost, 0.0);
  EXPECT_EQ(near.waypoints.size(), 2u);
  const PlanResult equal =
      world.plan("beam", vector_of({0.5, 0.5}), vector_of({0.5, 0.5}), {{"step", "0.05"}});
  EXPECT_EQ(equal.waypoints.size(), 1u);
  EXPECT_FALSE(equal.last_segment);
}

TEST(Beam, LastSegmentIsCostedApartAndCanBeLeftOut) {
  const BeamWorld world(load_robot("point"), VoxelScene{});
  const Configuration start = vector_of({0.0, 0.0}), goal = vector_of({1.02, 0.53});
  const PlanResult with = world.plan("beam", start, goal, {{"step", "0.05"}});
  const PlanResult without = world.plan("beam", start, goal, {{"step", "0.05"}, {"last_segment", "false"}});
  EXPECT_EQ(with.cost, without.cost);
  EXPECT_EQ(with.search_steps, without.search_steps);
  EXPECT_EQ(with.waypoints.size(), without.waypoints.size() + 1);
  EXPECT_EQ(with.waypoints.back(), goal);
  EXPECT_NEAR(with.cost + with.last_segment_cost, world.cost(with.waypoints), 1e-9);
  EXPECT_NEAR(without.cost, world.cost(without.waypoints), 1e-9);
  EXPECT_LE(((without.waypoints.back() - goal).cwiseAbs()).maxCoeff(), 0.05 + 1e-9);
}

TEST(Beam, JointLimitsAreKept) {
  Robot robot = load_robot("point");
  robot.joints[1].lower = -0.3, robot.joints[1].upper = 0.3;
  VoxelScene scene;
  scene.resolution = 0.1;
  scene.occupied = {box_of(0.9, -0.4, -0.1, 1.1, 0.0, 0.1)};
  const BeamWorld world(robot, scene);
  const PlanResult result = world.plan("beam", vector_of({0.0, -0.25}), vector_of({2.0, -0.25}),
                                       {{"width", "60"}, {"step", "0.05"}});
  expect_valid(world, result, vector_of({0.0, -0.25}));
  for (const Configuration& q : result.waypoints) EXPECT_TRUE(std::abs(q[1]) <= 0.3);
}

TEST(Beam, InvalidEndsAreReportedInASentence) {
  const BeamWorld world(load_robot("point"), pocket());
  const Configuration free = vector_of({0.0, 0.0}), blocked = vector_of({1.05, 0.0}),
                      outside = vector_of({0.0, 500.0});
  const PlanResult start = world.plan("beam", blocked, free, {});
  EXPECT_EQ(start.status, PlanStatus::start_invalid);
  EXPECT_NE(start.explanation.find("occupied"), std::string::npos) << start.explanation;
  const PlanResult goal = world.plan("beam", free, outside, {});
  EXPECT_EQ(goal.status, PlanStatus::goal_invalid);
  EXPECT_NE(goal.explanation.find("limit"), std::string::npos) << goal.explanation;
  EXPECT_EQ(world.plan("beam", vector_of({0.0, std::nan("")}), free, {}).status, PlanStatus::start_invalid);
  EXPECT_EQ(world.plan("beam", vector_of({0.0}), free, {}).status, PlanStatus::start_invalid);
}

TEST(Beam, OutOfTimeItGivesTheBestPathSoFarOrTheBestNode) {
  const BeamWorld world(load_robot("point"), pocket());
  int asked = 0, most = 1 << 30;
  const PlanProblem problem{world.space,
                            world.cost,
                            vector_of({-0.5, 0.0}),
                            vector_of({2.0, 0.05}),
                            1,
                            [&] { return ++asked > most; }};
  const auto planner = make_planner("beam", {{"width", "40"}, {"step", "0.025"}});
  const PlanResult whole = planner->plan(problem);
  ASSERT_EQ(whole.status, PlanStatus::solved);
  ASSERT_LT(whole.statistics.at("first_goal_step"), whole.statistics.at("steps_searched"));
  EXPECT_EQ(whole.statistics.at("deadline_hit"), 0.0);
  const int all = asked;
  int solved = 0, timed_out = 0;
  for (most = 0; most < all; most += 1 + all / 40) {
    asked = 0;
    const PlanResult result = planner->plan(problem);
    EXPECT_LE(asked, most + 2);  // no more work after the deadline
    if (result.statistics.at("first_goal_step") < 0) {
      ++timed_out;
      EXPECT_EQ(result.status, PlanStatus::timed_out);
      EXPECT_FALSE(result.explored.empty());
      EXPECT_EQ(result.explanation.substr(0, 11), "out of time") << result.explanation;
    } else {
      ++solved;
      expect_valid(world, result, problem.start);
      EXPECT_GE(result.cost, whole.cost);
    }
    EXPECT_EQ(result.statistics.at("deadline_hit"), 1.0);
  }
  EXPECT_GT(solved, 0);
  EXPECT_GT(timed_out, 0);
}

TEST(Beam, LooksAtTheTimeAlsoBetweenNeighboursAtOneDistance) {
  const BeamWorld world(load_robot("puma560"), VoxelScene{});
  const Configuration start = Configuration::Zero(6), goal = Configuration::Constant(6, 0.5);
  int asked = 0;  // exact sums: 729 neighbours at 28 distances
  const PlanProblem problem{world.space, world.cost, start, goal, 0, [&] { return ++asked > 20; }};
  const PlanResult late = make_planner("beam", {{"step", "0.125"}, {"width", "1000"}})->plan(problem);
  EXPECT_EQ(late.status, PlanStatus::timed_out) << late.explanation;
  EXPECT_GT(late.statistics.at("neighbours_generated"), 20.0);
  EXPECT_LE(late.statistics.at("neighbours_generated"), 20.0 * 16.0);
}

}  // namespace beam_test
}  // namespace clearway
