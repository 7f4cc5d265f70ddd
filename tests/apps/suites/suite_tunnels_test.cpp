#include "apps/suites/suite_tunnels.hpp"

#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace suite_tunnels_test {

const SuiteGenerator coarse{.kind = "tunnels", .count = 6, .seed = 3, .resolution = 0.04};

TEST(SuiteTunnels, TheDrawnWayIsASolutionAndTheStraightEdgeIsNot) {
  const Robot robot = load_robot("puma560");
  for (std::size_t i = 0; i < 6; ++i) {
    const Tunnel tunnel = draw_tunnel(coarse, i, robot, {}, 0.0);
    const ConfigurationSpace space(robot, tunnel.map);
    EXPECT_EQ(space.policies().at("tool"), Policy::painted);
    EXPECT_GE(tunnel.way.size(), 5u);
    EXPECT_LE(tunnel.way.size(), 8u);
    EXPECT_FALSE(space.is_edge_free(tunnel.way.front(), tunnel.way.back()));
    // The independent check's word, not that of the code that drew.
    const PathVerdict whole = check_path(robot, tunnel.map, space.policies(), 0.0, tunnel.way);
    EXPECT_TRUE(whole.valid) << tunnel.world.name << ": " << whole.first_contact;
    const PathVerdict straight =
        check_path(robot, tunnel.map, space.policies(), 0.0, {tunnel.way.front(), tunnel.way.back()});
    EXPECT_FALSE(straight.valid) << tunnel.world.name;
  }
}

TEST(SuiteTunnels, PaddingIsKeptAlongTheWay) {
  const Robot robot = load_robot("puma560");
  const Tunnel tunnel = draw_tunnel(coarse, 0, robot, {}, 0.03);
  const ConfigurationSpace space(robot, tunnel.map);
  EXPECT_TRUE(check_path(robot, tunnel.map, space.policies(), 0.03, tunnel.way).valid);
}

TEST(SuiteTunnels, StrokesRunFromStartToGoalInStepsOfAThirdOfTheRadius) {
  const Tunnel tunnel = draw_tunnel(coarse, 1, load_robot("puma560"), {}, 0.0);
  const auto& strokes = tunnel.world.volumes.at(0).strokes;
  EXPECT_EQ(strokes.size(), tunnel.way.size() - 1);
  const double radius = strokes[0][0].radius;
  const double jitter = coarse.resolution;  // half a voxel at each of two spheres
  Eigen::Vector3d last = strokes[0][0].center;
  for (const auto& stroke : strokes) {
    for (const SuiteSphere& sphere : stroke) {
      EXPECT_NEAR(sphere.radius, radius, 1e-12);
      EXPECT_LE((sphere.center - last).norm(), radius / 3 + jitter + 0.01);
      last = sphere.center;
    }
  }
}

TEST(SuiteTunnels, TheSameIndexGivesTheSameTunnelAndAnotherSeedAnother) {
  const Robot robot = load_robot("puma560");
  const Tunnel once = draw_tunnel(coarse, 2, robot, {}, 0.0), again = draw_tunnel(coarse, 2, robot, {}, 0.0);
  EXPECT_EQ(once.way, again.way);
  EXPECT_EQ(map_sha256(once.map), map_sha256(again.map));
  SuiteGenerator other = coarse;
  other.seed = 4;
  EXPECT_NE(once.way.front(), draw_tunnel(other, 2, robot, {}, 0.0).way.front());
  EXPECT_NE(once.way.front(), draw_tunnel(coarse, 3, robot, {}, 0.0).way.front());
}

TEST(SuiteTunnels, AMiniatureHasMiniatureTunnels) {
  const Robot robot = load_robot("puma560_miniature");
  const SuiteGenerator fine{.kind = "tunnels", .count = 1, .seed = 3, .resolution = 0.004};
  const Tunnel tunnel = draw_tunnel(fine, 0, robot, {}, 0.0);
  EXPECT_LT(tunnel.world.volumes[0].strokes[0][0].radius, 0.03);
}

}  // namespace suite_tunnels_test
}  // namespace clearway
