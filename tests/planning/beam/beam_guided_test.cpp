#include "planning/beam/beam_guided.hpp"

#include <gtest/gtest.h>

#include "planning/beam/via_beam.hpp"
#include "planning/check/path_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/routes/route_guide.hpp"
#include "planning/space/joint_weights.hpp"
#include "tests/worlds/painted_tunnel.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace beam_guided_test {

PlanResult plan_in(const PaintedTunnel& tunnel, const ConfigurationSpace& space, const char* planner,
                   const PlannerOptions& options = {}) {
  const PathCost cost(space.robot());
  return make_planner(planner, options)->plan({space, cost, tunnel.start, tunnel.goal, 1});
}

TEST(BeamGuided, WindsThroughPaintedTunnelsThatStopThePapersBeam) {
  const Robot robot = load_robot("puma560");
  int solved = 0, beam_solved = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const PaintedTunnel tunnel(robot, seed, 3, 0.03);
    const ConfigurationSpace space(robot, tunnel.map);
    const PlanResult result = plan_in(tunnel, space, "beam_guided");
    beam_solved +=
        plan_in(tunnel, space, "beam", {{"width", "5"}, {"max_steps", "200"}}).status == PlanStatus::solved;
    if (result.status != PlanStatus::solved) continue;
    ++solved;
    EXPECT_EQ(result.waypoints.front(), tunnel.start);
    EXPECT_EQ(result.waypoints.back(), tunnel.goal);
    const PathVerdict verdict = check_path(robot, tunnel.map, space.policies(), 0.0, result.waypoints);
    EXPECT_TRUE(verdict.valid) << verdict.first_contact;
  }
  EXPECT_GE(solved, 9);
  EXPECT_LT(beam_solved, solved);
}

TEST(BeamGuided, TheSameSeedGivesTheSamePath) {
  const Robot robot = load_robot("puma560");
  const PaintedTunnel tunnel(robot, 3, 3, 0.03);
  const ConfigurationSpace space(robot, tunnel.map);
  const PlanResult first = plan_in(tunnel, space, "beam_guided"),
                   second = plan_in(tunnel, space, "beam_guided");
  EXPECT_EQ(first.waypoints, second.waypoints);
  EXPECT_EQ(first.edges_checked, second.edges_checked);
  EXPECT_EQ(first.configurations_checked, second.configurations_checked);
}

TEST(BeamGuided, OnceOutOfTimeItSaysSo) {
  const Robot robot = load_robot("puma560");
  const PaintedTunnel tunnel(robot, 4, 3, 0.03);
  const ConfigurationSpace space(robot, tunnel.map);
  const PathCost cost(robot);
  const PlanResult result =
      make_planner("beam_guided")->plan({space, cost, tunnel.start, tunnel.goal, 1, [] { return true; }});
  EXPECT_EQ(result.status, PlanStatus::timed_out);
  EXPECT_FALSE(result.explanation.empty());
  EXPECT_EQ(result.statistics.at("deadline_hit"), 1.0);
}

TEST(BeamGuided, SaysWhetherTheDeadlineWasHitWhenThereIsNoPathEither) {
  const Robot robot = load_robot("point");
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("paint", robot.critical_parts);
  map.begin_stroke("two rooms without a way between them");
  for (const double x : {0.0, 3.0}) map.paint(volume, {Eigen::Vector3d(x, 0, 0), 0.5});
  map.end_stroke();
  Policies policies;
  policies.other = Policy::painted;
  const ConfigurationSpace space(robot, map.snapshot(), policies);
  const PathCost cost(robot);
  const PlanResult result =
      make_planner("beam_guided")->plan({space, cost, Eigen::Vector2d(0, 0), Eigen::Vector2d(3, 0)});
  EXPECT_EQ(result.status, PlanStatus::no_path) << result.explanation;
  EXPECT_EQ(result.statistics.at("deadline_hit"), 0.0);
}

TEST(BeamGuided, FindsItsWayRoundAWallWhereNothingIsPainted) {
  const Robot robot = load_robot("point");
  const ConfigurationSpace space(
      robot, VoxelScene{0.05, {box_of(1, -2.0, -0.05, 1.1, 0.9, 0.05)}, {}, {}}.snapshot(),
      Policies{.parts = {}, .other = Policy::not_occupied, .critical_by_default = false});
  const PathCost cost(robot);
  const Eigen::Vector2d start(0.0, 0.0), goal(2.5, 0.0);
  const PlanResult result = make_planner("beam_guided")->plan({space, cost, start, goal, 1});
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  for (std::size_t i = 1; i < result.waypoints.size(); ++i) {
    EXPECT_TRUE(space.is_edge_free(result.waypoints[i - 1], result.waypoints[i]));
  }
}

TEST(ViaBeam, EveryHeadOnTheWayIsCertifiedAndFarthestLeadsThere) {
  const Robot robot = load_robot("puma560");
  for (std::uint64_t seed = 11; seed <= 13; ++seed) {
    const PaintedTunnel tunnel(robot, seed, 3, 0.03);
    const ConfigurationSpace space(robot, tunnel.map);
    const PathCost cost(robot);
    const PlanProblem problem{space, cost, tunnel.start, tunnel.goal, 1};
    const EndEffector hand = find_end_effector(space);
    const EndEffectorRoute route = find_end_effector_route(problem, hand);
    ASSERT_FALSE(route.points.empty());
    const ViaPath via = search_via_regions(problem, hand, route, joint_weights(space, 0.0), {});
    EXPECT_LE(via.reached, via.regions);
    ASSERT_FALSE(via.farthest.empty());
    for (const auto& path : {via.farthest, via.waypoints}) {
      for (std::size_t i = 1; i < path.size(); ++i) EXPECT_TRUE(space.is_edge_free(path[i - 1], path[i]));
    }
    if (via.reached < via.regions) continue;
    const Eigen::Vector3d end = hand.position(robot, via.farthest.back());
    EXPECT_LT((end - hand.position(robot, tunnel.goal)).norm(), hand.outer_radius);
  }
}

TEST(EndEffector, IsThePaintedPartAndItsSpheresAreInsideAndAround) {
  const Robot robot = load_robot("puma560");
  const PaintedTunnel tunnel(robot, 1, 1, 0.03);
  const ConfigurationSpace space(robot, tunnel.map);
  const EndEffector hand = find_end_effector(space);
  const Body& body = robot.bodies[static_cast<std::size_t>(hand.body)];
  EXPECT_EQ(body.part, robot.critical_parts.front());
  EXPECT_EQ(hand.requirement.policy, Policy::painted);
  EXPECT_GT(hand.inner_radius, 0.0);
  EXPECT_LE(hand.inner_radius, hand.outer_radius);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d way = random.point(1.0).normalized();
    EXPECT_LE(body.shape.signed_distance(0.999 * hand.inner_radius * way), 0.0);
    EXPECT_LE(body.shape.support(way).norm(), hand.outer_radius + 1e-12);
  }
}

}  // namespace beam_guided_test
}  // namespace clearway
