#include "apps/suites/suite_holes.hpp"

#include <gtest/gtest.h>

#include "apps/suites/suite_world.hpp"
#include "mapping/files/map_digest.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace suite_holes_test {

const SuiteGenerator coarse{.kind = "holes", .count = 4, .seed = 3, .resolution = 0.02};

TEST(SuiteHoles, ThePocketAndNothingElseBlocksTheStraightWay) {
  const Robot robot = load_robot("puma560");
  const std::map<std::string, Policy> policies = ConfigurationSpace(robot, Snapshot()).policies();
  for (std::size_t i = 0; i < 4; ++i) {
    const Hole hole = draw_hole(coarse, i, robot, {}, 0.0);
    ASSERT_EQ(hole.world.pockets.size(), 1U);
    SuiteWorld whole = hole.world;
    whole.pockets.clear();
    // The independent check's word, not that of the code that drew.
    const auto is_valid = [&](const Snapshot& map, const std::vector<Configuration>& path) {
      return check_path(robot, map, policies, 0.0, path).valid;
    };
    EXPECT_TRUE(is_valid(make_map(whole, robot.critical_parts), {hole.start, hole.goal})) << i;
    EXPECT_FALSE(is_valid(hole.map, {hole.start, hole.goal})) << i;
    EXPECT_TRUE(is_valid(hole.map, {hole.start}) && is_valid(hole.map, {hole.goal})) << i;
  }
}

TEST(SuiteHoles, EndsPaintAndPocketAreWhereTheRuleSays) {
  const Robot robot = load_robot("puma560");
  const Hole hole = draw_hole(coarse, 1, robot, {}, 0.0);
  const Eigen::VectorXd moved = (hole.goal - hole.start).cwiseAbs() * 180.0 / M_PI;
  EXPECT_GE(moved[0], 35.0);
  EXPECT_LE(moved[0], 50.0);
  EXPECT_LE(moved.tail(5).maxCoeff(), 8.0);
  const double hand = std::hypot(0.06, 0.075);  // half the diagonal of the tool's cylinder
  const auto& balls = hole.world.volumes.at(0).strokes.at(0);
  EXPECT_GE(balls.size(), 300U);
  EXPECT_LE(balls.size(), 800U);
  for (const SuiteSphere& ball : balls) {
    EXPECT_GE(ball.radius, 1.25 * hand);
    EXPECT_LE(ball.radius, 2.0 * hand);
  }
  EXPECT_GE(hole.world.pockets[0].radius, 0.1 * hand);
  EXPECT_LE(hole.world.pockets[0].radius, 0.6 * hand);
  SuiteGenerator large = coarse;
  large.kind = "large_holes";
  EXPECT_GE(draw_hole(large, 1, robot, {}, 0.0).world.pockets[0].radius, 0.6 * hand);
  EXPECT_EQ(hole.map.state(hole.world.pockets[0].center), VoxelState::unknown);
}

TEST(SuiteHoles, TheSameIndexGivesTheSameVolumeAndAnotherSeedAnother) {
  const Robot robot = load_robot("puma560");
  const Hole once = draw_hole(coarse, 2, robot, {}, 0.0), again = draw_hole(coarse, 2, robot, {}, 0.0);
  EXPECT_EQ(once.start, again.start);
  EXPECT_EQ(map_sha256(once.map), map_sha256(again.map));
  SuiteGenerator other = coarse;
  other.seed = 4;
  EXPECT_NE(once.start, draw_hole(other, 2, robot, {}, 0.0).start);
  EXPECT_NE(once.start, draw_hole(coarse, 3, robot, {}, 0.0).start);
}

TEST(SuiteHoles, AMiniatureHasMiniatureVolumes) {
  const Robot robot = load_robot("puma560_miniature");
  const SuiteGenerator fine{.kind = "holes", .count = 1, .seed = 3, .resolution = 0.002};
  const Hole small = draw_hole(fine, 0, robot, {}, 0.0);
  EXPECT_LT(small.world.volumes[0].strokes[0][0].radius, 0.02);
}

}  // namespace suite_holes_test
}  // namespace clearway
