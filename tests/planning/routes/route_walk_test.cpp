#include "planning/routes/route_walk.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/sampled_trees.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace route_walk_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The point robot (a disc of 0.2 m) and a route that turns: 1 m along x, then 1 m along y.
struct Corner {
  Robot robot = load_robot("point");
  ConfigurationSpace space{
      robot, VoxelScene{0.05, {}, {}, {}}.snapshot(), {.parts = {}, .critical_by_default = false}};
  EndEffector hand = find_end_effector(space);
  EndEffectorRoute route{{{0, 0, 0}, {0.3, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {0.1, 0.1, 0.1, 0.1}};
  RouteWalk walk{robot, hand, route};
  std::mt19937_64 random{1};

  Vector3d hand_at(const Configuration& q) const { return hand.position(robot, q); }
};

TEST(RouteWalk, BringsTheHandOnePlaceFartherFromEitherEnd) {
  Corner corner;
  const double spacing = 2.0 / (corner.walk.places() - 1);
  EXPECT_NEAR(spacing, corner.hand.outer_radius, 0.15 * corner.hand.outer_radius);
  const Vector2d at_start(0.0, 0.0), at_goal(1.0, 1.0);
  corner.walk.add(RouteWalk::start, 0, at_start);
  corner.walk.add(RouteWalk::goal, 0, at_goal);
  const double play = 0.25 * corner.hand.outer_radius;
  for (int i = 0; i < 100; ++i) {
    const auto from = corner.walk.choose(RouteWalk::start, corner.random);
    ASSERT_TRUE(from);
    EXPECT_EQ(from->place, 0);
    const auto to = corner.walk.step(RouteWalk::start, *from, at_start, corner.random);
    ASSERT_TRUE(to);
    // Within the play, an edge of a cube, and how far from there a hand may stop.
    EXPECT_LT((corner.hand_at(*to) - Vector3d(spacing, 0, corner.hand_at(*to).z())).norm(), 3.0 * play);
    const auto back = corner.walk.choose(RouteWalk::goal, corner.random);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->place, corner.walk.places() - 1);
    const auto down = corner.walk.step(RouteWalk::goal, *back, at_goal, corner.random);
    ASSERT_TRUE(down);
    EXPECT_LT((corner.hand_at(*down) - Vector3d(1, 1 - spacing, corner.hand_at(*down).z())).norm(),
              3.0 * play);
  }
}

TEST(RouteWalk, GoesOnFromTheForemostNodesMostOftenAndFromNoneThatIsFarAway) {
  Corner corner;
  EXPECT_FALSE(corner.walk.choose(RouteWalk::start, corner.random));
  corner.walk.add(RouteWalk::start, 7, Vector2d(0.4, 1.5));  // nowhere near the route
  EXPECT_FALSE(corner.walk.choose(RouteWalk::start, corner.random));
  corner.walk.add(RouteWalk::start, 1, Vector2d(0.0, 0.0));
  corner.walk.add(RouteWalk::start, 2, Vector2d(0.6, 0.0));
  corner.walk.add(RouteWalk::start, 3, Vector2d(1.0, 0.4));
  EXPECT_FALSE(corner.walk.choose(RouteWalk::goal, corner.random));  // these are the other tree's
  int chosen[4] = {};
  for (int i = 0; i < 1000; ++i) ++chosen[corner.walk.choose(RouteWalk::start, corner.random)->node];
  EXPECT_GT(chosen[3], 500);
  EXPECT_GT(chosen[2], chosen[1]);
  EXPECT_GT(chosen[1], 20);
  EXPECT_EQ(chosen[0], 0);
}

/// A planar arm of two joints has, for a hand position, but two configurations: the elbow's sides. With a
/// third joint it has many, and how far the steps spread tells how wide the walk looks.
double spread_of_steps(RouteWalk& walk, const Configuration& q, std::mt19937_64& random) {
  const auto from = walk.choose(RouteWalk::start, random);
  double widest = 0.0;
  for (int i = 0; i < 200; ++i)
    if (const auto to = walk.step(RouteWalk::start, *from, q, random))
      widest = std::max(widest, (*to - q).lpNorm<Eigen::Infinity>());
  return widest;
}

TEST(RouteWalk, LooksWiderWhereStepsAreBlockedAndNarrowerAgainWhereTheyAreFree) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, VoxelScene{0.05, {}, {}, {}}.snapshot(),
                                 {.parts = {}, .critical_by_default = false});
  const EndEffector hand = find_end_effector(space);
  Configuration q(6);
  q << 0.2, -0.6, 0.4, 0.1, 0.7, 0.0;
  const Vector3d at = hand.position(robot, q);
  RouteWalk walk(robot, hand, {{at, at + Vector3d(0.0, 0.4, 0.0)}, {0.1, 0.1}});
  walk.add(RouteWalk::start, 0, q);
  std::mt19937_64 random(3);
  const double before = spread_of_steps(walk, q, random);
  for (int i = 0; i < 40; ++i) walk.learn(RouteWalk::start, false);
  const double blocked = spread_of_steps(walk, q, random);
  EXPECT_GT(blocked, 2.0 * before);
  for (int i = 0; i < 40; ++i) walk.learn(RouteWalk::start, true);
  EXPECT_LT(spread_of_steps(walk, q, random), before);
  for (int i = 0; i < 200; ++i) {  // within the limits however wide
    walk.learn(RouteWalk::start, false);
    const auto to = walk.step(RouteWalk::start, {0, 0}, q, random);
    if (!to) continue;
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      EXPECT_GE((*to)[static_cast<Eigen::Index>(j)], robot.joints[j].lower);
      EXPECT_LE((*to)[static_cast<Eigen::Index>(j)], robot.joints[j].upper);
    }
  }
}

TEST(RouteWalk, AHandThatDoesNotGetThereMakesNoStep) {
  Corner corner;
  RouteWalk walk(corner.robot, corner.hand, {{{0, 0, 0}, {0, 0, 50}}, {0.1, 0.1}});  // it lies in the plane
  walk.add(RouteWalk::start, 0, Vector2d(0.0, 0.0));
  const auto from = walk.choose(RouteWalk::start, corner.random);
  ASSERT_TRUE(from);
  EXPECT_FALSE(walk.step(RouteWalk::start, *from, Vector2d(0.0, 0.0), corner.random));
}

TEST(RouteWalk, SharesOfAGuideAddUp) {
  Corner corner;
  const PathCost cost(corner.robot);
  const PlanProblem problem{corner.space, cost, Vector2d(0, 0), Vector2d(1, 1)};
  for (const double share : {0.3, 0.6, 1.0}) {
    const TreeGuide guide = guide_along(problem, corner.hand, corner.route, share);
    ASSERT_TRUE(guide.walk != nullptr && guide.sample);
    int proposed = 0;
    constexpr int rounds = 20000;
    for (int i = 0; i < rounds; ++i) proposed += guide.sample(corner.random).has_value();
    const double all = guide.walk_share + (1.0 - guide.walk_share) * proposed / rounds;
    EXPECT_LT(all, share + 0.01);
    EXPECT_GT(all, 0.8 * share);  // some places are out of the hand's reach
    EXPECT_GT(proposed, 0);
  }
  EXPECT_TRUE(guide_along(problem, corner.hand, {}, 0.6).walk == nullptr);
  EXPECT_TRUE(guide_along(problem, corner.hand, corner.route, 0.0).walk == nullptr);
}

}  // namespace route_walk_test
}  // namespace clearway
