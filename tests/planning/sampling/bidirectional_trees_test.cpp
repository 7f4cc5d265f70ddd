#include "planning/sampling/bidirectional_trees.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace two_trees_test {

using Eigen::Vector2d;

/// The point robot (a disc of 0.2 m) before a wall with open ends.
struct Wall {
  Robot robot = load_robot("point");
  ConfigurationSpace space;
  PathCost cost;
  PlanProblem problem;

  explicit Wall(std::vector<Eigen::AlignedBox3d> walls = {box_of(1, -0.8, -0.05, 1.1, 0.8, 0.05)})
      : space(robot, VoxelScene{0.05, std::move(walls), {}, {}}.snapshot(),
              {.parts = {}, .critical_by_default = false}),
        cost(robot),
        problem{space, cost, Vector2d(0.0, 0.0), Vector2d(2.5, 0.0)} {}

  BidirectionalTrees trees() const { return {problem, Eigen::VectorXd::Ones(2)}; }
  void expect_path(const BidirectionalTrees& trees) const {
    const std::vector<Configuration> path = trees.path();
    EXPECT_EQ(path.front(), problem.start);
    EXPECT_EQ(path.back(), problem.goal);
    for (std::size_t i = 1; i < path.size(); ++i) EXPECT_TRUE(space.is_edge_free(path[i - 1], path[i])) << i;
  }
};

TEST(BidirectionalTrees, SamplesJoinStartAndGoalRoundAWall) {
  const Wall scene;
  for (const std::uint64_t seed : {1, 2, 3}) {
    BidirectionalTrees trees = scene.trees();
    std::mt19937_64 random(seed);
    ASSERT_TRUE(trees.grow(2000, random));
    scene.expect_path(trees);
    EXPECT_NEAR(trees.sampled_share(), 1.0, 1e-12);  // there is nothing else
    BidirectionalTrees again = scene.trees();
    std::mt19937_64 same(seed);
    again.grow(2000, same);
    EXPECT_EQ(trees.path(), again.path());
  }
}

TEST(BidirectionalTrees, TracesAreJoinedWhereTheySeeEachOther) {
  const Wall scene;
  BidirectionalTrees trees = scene.trees();
  const std::vector<Configuration> up{scene.problem.start, Vector2d(0.0, 0.5), Vector2d(0.0, 1.2),
                                      Vector2d(-0.5, 1.2)};
  EXPECT_EQ(trees.add_trace(BidirectionalTrees::start, 0, up), 3);
  EXPECT_FALSE(trees.join(BidirectionalTrees::start, 1, 0.1, 4));  // the goal's root alone is not seen
  const std::vector<Configuration> there{scene.problem.goal, Vector2d(2.5, 1.2)};
  EXPECT_EQ(trees.add_trace(BidirectionalTrees::goal, 0, there), 1);
  ASSERT_TRUE(trees.join(BidirectionalTrees::goal, 1, 0.1, 4));
  scene.expect_path(trees);
  EXPECT_EQ(trees.sampled_share(), 0.0);
}

TEST(BidirectionalTrees, SayWhichEndMayBeWalledIn) {
  const Wall open,
      closed({box_of(2.2, -0.3, -0.05, 2.25, 0.35, 0.05), box_of(2.75, -0.3, -0.05, 2.8, 0.35, 0.05),
              box_of(2.2, -0.3, -0.05, 2.8, -0.25, 0.05), box_of(2.2, 0.3, -0.05, 2.8, 0.35, 0.05)});
  BidirectionalTrees trees = closed.trees();
  std::mt19937_64 random(1);
  ASSERT_FALSE(trees.grow(3000, random));
  const auto count = [&](BidirectionalTrees::Side side) { return std::to_string(trees.nodes(side).size()); };
  EXPECT_EQ(trees.reach(), "Configurations: " + count(BidirectionalTrees::start) +
                               " reached from the start, " + count(BidirectionalTrees::goal) +
                               " from the goal: the goal may be walled in.");
  EXPECT_EQ(open.trees().reach(), "Configurations: 1 reached from the start, 1 from the goal.");
  for (int samples = 1; samples < 10; ++samples) {  // one tree has left its root's place, the other not yet
    BidirectionalTrees few = open.trees();
    few.grow(samples, random);
    EXPECT_EQ(few.reach().find("walled in"), std::string::npos) << few.reach();
  }
}

TEST(BidirectionalTrees, NameTheOriginOfEachEdgeOfThePath) {
  const Wall scene;
  BidirectionalTrees trees = scene.trees();
  const WaypointOrigin first{PathPhase::free_motion, {}, 1}, second{PathPhase::boundary, "disc", 2},
      third{PathPhase::boundary, "disc", 3};
  trees.add_trace(BidirectionalTrees::start, 0, {scene.problem.start, Vector2d(0.0, 0.6), Vector2d(0.0, 1.2)},
                  {{}, first, second});
  trees.add_trace(BidirectionalTrees::goal, 0, {scene.problem.goal, Vector2d(2.5, 1.2)}, {{}, third});
  ASSERT_TRUE(trees.join(BidirectionalTrees::goal, 1, 0.1, 4));
  EXPECT_EQ(trees.path_origins(),
            (std::vector<WaypointOrigin>{{}, first, second, {PathPhase::start_tree, {}, 3}, third}));
  BidirectionalTrees sampled = scene.trees();
  std::mt19937_64 random(3);
  ASSERT_TRUE(sampled.grow(2000, random));
  const std::vector<WaypointOrigin> origins = sampled.path_origins();
  ASSERT_EQ(origins.size(), sampled.path().size());
  for (std::size_t i = 1; i < origins.size(); ++i) {
    const bool is_start = origins[i].phase == PathPhase::start_tree;
    EXPECT_TRUE(is_start || origins[i].phase == PathPhase::goal_tree);
    const auto node = static_cast<std::size_t>(origins[i].search_step);
    if (is_start) {
      EXPECT_EQ(sampled.nodes(BidirectionalTrees::start).at(node).q, sampled.path()[i]);
    } else {
      EXPECT_EQ(sampled.nodes(BidirectionalTrees::goal).at(node).q, sampled.path()[i - 1]);
    }
  }
}

TEST(BidirectionalTrees, SamplesGrowFromTracesAndTheirShareIsReported) {
  const Wall scene;
  BidirectionalTrees trees = scene.trees();
  trees.add_trace(BidirectionalTrees::start, 0,
                  {scene.problem.start, Vector2d(0.0, 0.6), Vector2d(0.0, 1.2)});
  std::mt19937_64 random(5);
  ASSERT_TRUE(trees.grow(2000, random));
  scene.expect_path(trees);
  EXPECT_GT(trees.sampled_share(), 0.0);
}

TEST(BidirectionalTrees, AGuideIsAskedFirstAndTheDeadlineKept) {
  Wall scene;
  BidirectionalTrees trees(scene.problem, Eigen::VectorXd::Ones(2), 3.0);  // as far as the guide points
  std::mt19937_64 random(1);
  const SampleGuide over = [](std::mt19937_64&) -> std::optional<Configuration> {
    return Vector2d(1.0, 1.3);
  };
  ASSERT_TRUE(trees.grow(4, random, {.sample = over}));
  const auto path = trees.path();
  EXPECT_NE(std::find(path.begin(), path.end(), Configuration(Vector2d(1.0, 1.3))), path.end());
  scene.problem.out_of_time = [] { return true; };
  BidirectionalTrees late = scene.trees();
  EXPECT_FALSE(late.grow(100, random));
  EXPECT_EQ(late.samples(), 0);
}

/// All samples lie in one line behind the wall: only steps aside lead round it.
TEST(BidirectionalTrees, StepsAsideLeadRoundWhatBlocksASample) {
  const Wall scene;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    BidirectionalTrees trees = scene.trees();
    std::mt19937_64 random(seed);
    const SampleGuide straight = [](std::mt19937_64& drawn) -> std::optional<Configuration> {
      return Vector2d(2.5 * static_cast<double>(drawn() >> 11U) * 0x1p-53, 0.0);
    };
    ASSERT_TRUE(trees.grow(2000, random, {.sample = straight}));
    scene.expect_path(trees);
  }
}

/// Joints that turn eight times: 63 of 64 configurations are copies of the poses of one turn.
TEST(BidirectionalTrees, MostSamplesLieWithinOneTurnAboutStartAndGoal) {
  Robot robot = load_robot("planar2");
  for (Joint& joint : robot.joints)
    joint.lower = -8.0 * std::numbers::pi, joint.upper = 8.0 * std::numbers::pi;
  const ConfigurationSpace space(robot, VoxelScene{0.05, {}, {}, {}}.snapshot(),
                                 {.critical_by_default = false});
  const PathCost cost(robot);
  const PlanProblem problem{space, cost, Vector2d(1.0, 0.0), Vector2d(2.0, 0.0)};
  BidirectionalTrees trees(problem, Eigen::VectorXd::Ones(2), 100.0);  // nodes are the samples
  std::mt19937_64 random(1);
  std::size_t near = 0, all = 0;
  for (int round = 0; round < 40 && all < 300; ++round) {
    trees.grow(1, random);
    all = near = 0;
    for (const BidirectionalTrees::Node& node : trees.nodes(BidirectionalTrees::start)) {
      near += (node.q - Vector2d(1.5, 0.0)).lpNorm<Eigen::Infinity>() <= std::numbers::pi + 1e-9;
      ++all;
    }
  }
  EXPECT_GT(all, 20U);
  EXPECT_GT(4 * near, 3 * all);
}

TEST(BidirectionalTrees, JoiningTriesTheNearestNodesTheLatestOfEquallyNearOnesFirst) {
  Wall scene;
  int asked = 0;
  scene.problem.out_of_time = [&] { return ++asked > 1; };
  BidirectionalTrees late = scene.trees();
  EXPECT_FALSE(late.join(BidirectionalTrees::start, 0, 0.1, 4));  // out of time before its only edge
  EXPECT_EQ(late.edges_checked(), 0u);
  scene.problem.out_of_time = [] { return false; };
  BidirectionalTrees trees = scene.trees();
  trees.add_trace(BidirectionalTrees::goal, 0,
                  {scene.problem.goal, Vector2d(0.0, 0.9), Vector2d(0.3, 0.0), Vector2d(0.0, -0.3)});
  ASSERT_TRUE(trees.join(BidirectionalTrees::start, 0, 0.1, 4));
  EXPECT_EQ(trees.edges_checked(), 1u);
  EXPECT_EQ(trees.path()[1], Configuration(Vector2d(0.0, -0.3)));
}

}  // namespace two_trees_test
}  // namespace clearway
