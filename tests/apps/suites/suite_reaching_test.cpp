#include "apps/suites/suite_reaching.hpp"

#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace suite_reaching_test {

const Policies open{.parts = {}, .critical_by_default = false};

SuiteGenerator coarse(const std::string& kind, int count) {
  return {.kind = kind, .count = count, .seed = 3, .resolution = 0.05};
}

/// The first region that holds the tip at q, -1: none.
int region_of(const ReachingScene& scene, const Robot& robot, const Configuration& q) {
  const Eigen::Vector3d tip = tip_pose(robot, q).translation();
  for (std::size_t i = 0; i < scene.regions.size(); ++i) {
    const TipRegion& region = scene.regions[i];
    const Eigen::Vector3d at = region.map_from_region.inverse() * tip;
    const double slack = 1e-5;
    if ((at.array() >= region.low.array() - slack).all() && (at.array() <= region.high.array() + slack).all())
      return static_cast<int>(i);
  }
  return -1;
}

struct Draw {
  const char *kind, *robot;
};
void PrintTo(const Draw& draw, std::ostream* out) { *out << draw.kind << " " << draw.robot; }

class SuiteReaching : public testing::TestWithParam<Draw> {};

TEST_P(SuiteReaching, EndsAreFreeInTheirRegionsAndTheStraightEdgeIsBlocked) {
  const Robot robot = load_robot(GetParam().robot);
  const ReachingScene scene = draw_reaching(coarse(GetParam().kind, 4), 0, robot, open, 0.0);
  const ConfigurationSpace space(robot, scene.map, open);
  ASSERT_EQ(scene.problems.size(), 4u);
  for (const StageProblem& problem : scene.problems) {
    ASSERT_EQ(problem.goals.size(), 1u);
    const Configuration &start = problem.start, &goal = problem.goals[0];
    // The independent check's word: an end is a path of no length.
    for (const Configuration& end : {start, goal}) {
      EXPECT_TRUE(check_path(robot, scene.map, space.policies(), 0.0, {end, end}).valid) << problem.name;
    }
    EXPECT_FALSE(space.is_edge_free(start, goal)) << problem.name;
    if (scene.regions.empty()) continue;
    EXPECT_GE(region_of(scene, robot, start), 0) << problem.name;
    EXPECT_GE(region_of(scene, robot, goal), 0) << problem.name;
    EXPECT_NE(region_of(scene, robot, start), region_of(scene, robot, goal)) << problem.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SuiteReaching,
                         testing::Values(Draw{"shelf", "puma560"}, Draw{"table", "arm5"},
                                         Draw{"ladder", "panda"}, Draw{"cage", "arm5"},
                                         Draw{"boxes", "puma560"}),
                         [](const auto& draw) { return std::string(draw.param.kind); });

TEST(SuiteReachingScenes, AProblemIsTheSameWhateverTheCount) {
  const Robot robot = load_robot("arm5");
  const ReachingScene few = draw_reaching(coarse("table", 12), 1, robot, open, 0.0);
  const ReachingScene many = draw_reaching(coarse("table", 15), 1, robot, open, 0.0);
  ASSERT_EQ(few.problems.size(), 2u);
  ASSERT_EQ(many.problems.size(), 5u);
  EXPECT_EQ(map_sha256(few.map), map_sha256(many.map));
  EXPECT_EQ(few.problems[1].name, "table 2.2");
  for (std::size_t i = 0; i < few.problems.size(); ++i) {
    EXPECT_EQ(few.problems[i].start, many.problems[i].start);
    EXPECT_EQ(few.problems[i].goals, many.problems[i].goals);
  }
}

TEST(SuiteReachingScenes, ASceneGrowsWithTheArm) {
  const Robot robot = load_robot("puma560");
  const Robot small = scaled(robot, 0.5);
  EXPECT_NEAR(arm_reach(small).length, 0.5 * arm_reach(robot).length, 1e-9);
  const ReachingScene scene = draw_obstacles("ladder", robot, arm_reach(robot), 1, 0);
  const ReachingScene half = draw_obstacles("ladder", small, arm_reach(small), 1, 0);
  ASSERT_EQ(scene.regions.size(), half.regions.size());
  EXPECT_TRUE(half.regions[0].high.isApprox(0.5 * scene.regions[0].high, 1e-9));
}

TEST(SuiteReachingScenes, APolicyThatNothingInTheMapKeepsIsRefusedBeforeTheDraws) {
  const Robot robot = load_robot("puma560");
  const Policies painted{.parts = {{"tool", Policy::painted}}, .other = Policy::not_occupied};
  try {
    draw_reaching(coarse("boxes", 1), 0, robot, painted, 0.0);
    ADD_FAILURE() << "problems were drawn";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(
        error.what(),
        "boxes: no problem found for robot 'puma560' under tool painted, other parts not_occupied in "
        "'boxes 1': part 'tool' must lie in paint, of which its map has none; expected other "
        "`policies`, such as {default: not_occupied}");
  }
}

TEST(SuiteReachingScenes, AnUnknownKindIsRefused) {
  const Robot robot = load_robot("arm5");
  EXPECT_THROW(draw_obstacles("maze", robot, arm_reach(robot), 1, 0), std::invalid_argument);
}

}  // namespace suite_reaching_test
}  // namespace clearway
