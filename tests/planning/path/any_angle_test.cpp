#include "planning/path/any_angle.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "planning/space/joint_weights.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace any_angle_test {

using Path = std::vector<Configuration>;

struct Arm {
  Robot robot = load_robot("puma560");
  ConfigurationSpace space{
      robot, VoxelScene{0.05, {box_of(0.4, -0.3, 0.2, 0.6, 0.3, 0.4)}, {}, {}}.snapshot(),
      Policies{.parts = {}, .other = Policy::not_occupied, .critical_by_default = false}};
  PathCost cost{robot};
  Eigen::VectorXd weight = joint_weights(space, 0.0);

  /// A path of certified edges between random configurations.
  Path random_path(Random& random, int edges) const {
    Path path;
    while (static_cast<int>(path.size()) <= edges) {
      Configuration q = random.configuration(robot);
      if (!path.empty()) q = path.back() + 0.3 * (q - path.back());
      if (!space.is_free(q) || (!path.empty() && !space.is_edge_free(path.back(), q))) continue;
      path.push_back(q);
    }
    return path;
  }
};

TEST(AnyAngle, CostsNoMoreKeepsItsEndsAndIsCertifiedEdgeByEdge) {
  const Arm arm;
  Random random(1);
  double saved = 0.0;
  for (int round = 0; round < 12; ++round) {
    const Path path = arm.random_path(random, 6);
    const PlanProblem problem{arm.space, arm.cost, path.front(), path.back(), 7};
    std::uint64_t edges = 0;
    const Path better = straightened(problem, path, arm.weight, {}, edges);
    EXPECT_EQ(better.front(), path.front());
    EXPECT_EQ(better.back(), path.back());
    EXPECT_GT(edges, 0u);
    for (std::size_t i = 1; i < better.size(); ++i)
      EXPECT_TRUE(arm.space.is_edge_free(better[i - 1], better[i]));
    // Sampled ten times as finely as the pass does.
    const double before = sampled_cost(arm.cost, path, arm.weight, 0.005),
                 after = sampled_cost(arm.cost, better, arm.weight, 0.005);
    EXPECT_LE(after, before * 1.001);
    saved += 1.0 - after / before;
    std::uint64_t again = 0;
    EXPECT_EQ(straightened(problem, path, arm.weight, {}, again), better);
    EXPECT_EQ(again, edges);
  }
  EXPECT_GT(saved / 12, 0.2);
}

TEST(AnyAngle, SampledCostIsTheCostOfTheFinelyDividedPath) {
  const Arm arm;
  Random random(2);
  const Path path = arm.random_path(random, 3);
  Path fine;
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (int k = 0; k < 2000; ++k) fine.push_back(path[i - 1] + k / 2000.0 * (path[i] - path[i - 1]));
  }
  fine.push_back(path.back());
  EXPECT_NEAR(sampled_cost(arm.cost, path, arm.weight, 0.01), arm.cost(fine), 1e-3 * arm.cost(fine));
  EXPECT_EQ(sampled_cost(arm.cost, {path.front()}, arm.weight, 0.01), 0.0);
}

TEST(AnyAngle, OutOfTimeItReturnsACertifiedPath) {
  const Arm arm;
  Random random(3);
  const Path path = arm.random_path(random, 6);
  const PlanProblem problem{arm.space, arm.cost, path.front(), path.back(), 1, [] { return true; }};
  std::uint64_t edges = 0;
  const Path same = straightened(problem, path, arm.weight, {}, edges);
  EXPECT_EQ(same, path);
  EXPECT_EQ(edges, 0u);
}

}  // namespace any_angle_test
}  // namespace clearway
