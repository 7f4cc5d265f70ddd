#include "planning/path/rounded_corners.hpp"

#include <gtest/gtest.h>

#include <random>

#include "mapping/system/random_unit.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace rounded_corners_test {

using Eigen::Vector2d;
using Path = std::vector<Configuration>;

/// The point robot (a disc of 0.2 m) and a path with a right angle about a post.
struct Corner {
  Robot robot = load_robot("point");
  ConfigurationSpace space;
  PathCost cost;
  PlanProblem problem;
  Path path{Vector2d(0.0, 0.0), Vector2d(1.0, 0.0), Vector2d(1.0, 1.0)};
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(2);
  std::uint64_t edges = 0;

  explicit Corner(const Eigen::AlignedBox3d& post)
      : space(robot, VoxelScene{0.05, {post}, {}, {}}.snapshot(),
              {.parts = {}, .critical_by_default = false}),
        cost(robot),
        problem{space, cost, Vector2d(0.0, 0.0), Vector2d(1.0, 1.0)} {}

  Path rounded(const RoundingOptions& options = {}) {
    Path result = rounded_corners(problem, path, weight, options, edges);
    EXPECT_EQ(result.front(), path.front());
    EXPECT_EQ(result.back(), path.back());
    for (std::size_t i = 1; i < result.size(); ++i)
      EXPECT_TRUE(space.is_edge_free(result[i - 1], result[i])) << i;
    return result;
  }
  double nearest_to_corner(const Path& result) const {
    double nearest = 1e9;
    for (const Configuration& q : result) nearest = std::min(nearest, (q - path[1]).norm());
    return nearest;
  }
};

TEST(RoundedCorners, TurnsAreSpreadOverAnArc) {
  Corner scene(box_of(5, 5, -0.05, 5.1, 5.1, 0.05));
  EXPECT_NEAR(sharpest_turn(scene.path, scene.weight), M_PI / 2, 1e-9);
  const Path result = scene.rounded();
  EXPECT_LE(sharpest_turn(result, scene.weight), RoundingOptions().turn + 1e-6);
  EXPECT_NEAR(scene.nearest_to_corner(result), 0.4 / 2.0 / std::sqrt(2.0), 0.01);  // a Bezier arc of 0.4
}

TEST(RoundedCorners, ASharpCornerTurnsNoFasterThanAsked) {
  Corner scene(box_of(5, 5, -0.05, 5.1, 5.1, 0.05));
  for (const double turn : {0.16, 0.5, 1.0, 2.0, 2.6}) {
    scene.path[2] = scene.path[1] + Configuration(Vector2d(std::cos(turn), std::sin(turn)));
    EXPECT_NEAR(sharpest_turn(scene.path, scene.weight), turn, 1e-9);
    EXPECT_LE(sharpest_turn(scene.rounded(), scene.weight), RoundingOptions().turn + 1e-6) << turn;
  }
}

TEST(RoundedCorners, ArcsThatMeetOnAnEdgeLeaveNoTwoPointsThereAndNoReversedEdge) {
  Corner scene(box_of(5, 5, -0.05, 5.1, 5.1, 0.05));
  std::mt19937_64 random(7);
  const auto drawn = [&](double low, double high) { return low + (high - low) * random_unit(random); };
  for (int i = 0; i < 50; ++i) {
    scene.path = {Vector2d(drawn(-0.5, 0.5), drawn(-0.5, 0.5))};
    for (double at = drawn(-3.0, 3.0); scene.path.size() < 8; at += drawn(-2.5, 2.5)) {
      const double far = drawn(0.1, 0.5);  // both corners of an edge want half of it
      scene.path.push_back(scene.path.back() + Configuration(far * Vector2d(std::cos(at), std::sin(at))));
    }
    const Path result = scene.rounded();
    for (std::size_t k = 1; k < result.size(); ++k)
      EXPECT_GE((result[k] - result[k - 1]).norm(), 1e-9) << i << " " << k;
    EXPECT_LE(sharpest_turn(result, scene.weight), RoundingOptions().turn + 1e-6) << i;
  }
}

TEST(RoundedCorners, AnArcShrinksUntilItIsFree) {
  Corner open(box_of(5, 5, -0.05, 5.1, 5.1, 0.05)), tight(box_of(0.6, 0.25, -0.05, 0.75, 0.4, 0.05));
  const double wide = open.nearest_to_corner(open.rounded({.longest = 0.5}));
  const double narrow = tight.nearest_to_corner(tight.rounded({.longest = 0.5}));
  EXPECT_LT(narrow, wide);
  EXPECT_GT(narrow, 0.0);
}

TEST(RoundedCorners, AnArcComesNoNearerThanTheClearanceAllows) {
  Corner scene(box_of(0.6, 0.3, -0.05, 0.7, 0.4, 0.05));
  const auto clearance = [&](const RoundingOptions& options) {
    double nearest = 1.0;
    for (const Configuration& q : scene.rounded(options))
      nearest = std::min(nearest, scene.space.clearance(q));
    return nearest;
  };
  EXPECT_LT(clearance({.longest = 0.5}), 0.06);
  EXPECT_GE(clearance({.longest = 0.5, .least_clearance = 0.08}), 0.08);
}

TEST(RoundedCorners, WithoutTimeAPathStaysAsItIs) {
  Corner scene(box_of(5, 5, -0.05, 5.1, 5.1, 0.05));
  scene.problem.out_of_time = [] { return true; };
  EXPECT_EQ(scene.rounded(), scene.path);
  EXPECT_EQ(scene.edges, 0u);
}

TEST(RoundedCorners, WhereWeightsHardlySeparatePointsEveryEdgeIsCertified) {
  Corner corner(box_of(9.9, 5.9, -0.05, 10.1, 6.1, 0.05));
  corner.weight.setConstant(9e-11);  // nine metres are next to nothing
  corner.path = {Vector2d(-1.0, -1.0), Vector2d(0.0, 0.0), Vector2d(0.0, 9.0), Vector2d(30.0, 9.0),
                 Vector2d(50.0, -25.0)};
  corner.rounded();
}

}  // namespace rounded_corners_test
}  // namespace clearway
