#include "apps/pages/map_page.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/free_space_map.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/planned_motion.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace map_page_test {

/// A wall of occupied voxels in the plane y = 2, from x = -1 to 1.
Snapshot wall() {
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  for (double x = -1.0; x <= 1.0; x += 0.05)
    for (double z = 0.0; z <= 1.0; z += 0.05)
      scan.points.emplace_back(static_cast<float>(x), 2.0F, static_cast<float>(z));
  map.insert(scan, {.max_range = 10.0});
  return map.snapshot();
}

double azimuth_from(const Eigen::Vector3d& from) {
  ReportPage page;
  look_from(page, wall(), from);
  return page.iso_azimuth_deg;
}

/// 0 is from -y, 90 from +x; the eye stands 25 degrees beside.
TEST(MapPage, TheFirstViewIsFromTheSideOfTheWallThatOneStandsOn) {
  EXPECT_NEAR(azimuth_from({0.0, 0.0, 0.0}), 25.0, 2.0);
  EXPECT_NEAR(azimuth_from({4.0, 2.0, 0.0}), 115.0, 2.0);
  EXPECT_NEAR(std::abs(azimuth_from({0.0, 4.0, 0.0})), 205.0, 2.0);
}

TEST(MapPage, TheFirstViewStaysWhereOneIsAmidTheVoxelsOrThereAreNone) {
  EXPECT_EQ(azimuth_from({0.0, 2.05, 0.5}), ReportPage().iso_azimuth_deg);
  ReportPage page;
  look_from(page, FreeSpaceMap({.resolution = 0.1}).snapshot(), {1.0, 2.0, 3.0});
  EXPECT_EQ(page.iso_azimuth_deg, ReportPage().iso_azimuth_deg);
}

/// A motion in time, whose corners are not the path's waypoints: what leads away from the goal was a step
/// along the boundary (the local method always comes nearer).
TEST(MapPage, ShowsOfTheWholeMotionHowThePlannerGotThere) {
  const VoxelScene scene{0.05, {box_of(1, -0.6, -0.05, 1.1, 0.9, 0.05)}, {}, {}};
  const ConfigurationSpace space(load_robot("point"), scene.snapshot(),
                                 {.parts = {}, .critical_by_default = false});
  const Configuration start = Eigen::Vector2d(0.0, 0.0), goal = Eigen::Vector2d(2.5, 0.05);
  const Plan plan = plan_and_check(
      {.space = space, .start = start, .goals = {goal}, .planner = make_planner("boundary", {})});
  ASSERT_TRUE(plan.is_proved()) << plan.explanation();
  const PagePlan page = page_of_plan(plan, space, start, "round the wall");
  ASSERT_EQ(page.phases.size(), page.waypoints.size());
  ASSERT_EQ(page.search_steps.size(), page.waypoints.size());
  EXPECT_EQ(page.phase_names.front(), "free motion");
  int away = 0, free = 0;
  for (std::size_t i = 1; i < page.waypoints.size(); ++i) {
    const std::string& name = page.phase_names.at(static_cast<std::size_t>(page.phases[i]));
    EXPECT_GE(page.search_steps[i], page.search_steps[i - 1]);
    free += name == "free motion";
    if ((goal - page.waypoints[i]).norm() <= (goal - page.waypoints[i - 1]).norm() + 1e-3) continue;
    ++away;
    EXPECT_EQ(name.rfind("boundary: ", 0), 0U) << i << ": " << name;
  }
  EXPECT_GT(away, 5);
  EXPECT_GT(free, 5);
  EXPECT_EQ(page.search_steps.back(), plan.legs.front().search_steps);
}

/// A load of the second leg lies where it is taken, and then rides, to the knot, and counts in the
/// separation.
TEST(MapPage, ShowsALoadWhereItIsAllAlongASmoothMotion) {
  const VoxelScene scene{0.05, {box_of(1, -0.6, -0.05, 1.1, 0.9, 0.05)}, {}, {}};
  const ConfigurationSpace space(load_robot("point"), scene.snapshot(),
                                 {.parts = {}, .critical_by_default = false});
  const Configuration start = Eigen::Vector2d(0.0, 0.0), goal = Eigen::Vector2d(2.5, 0.05);
  LegLoad ball;
  ball.load.name = "ball";
  ball.load.link = "base";
  ball.load.shape = Shape::sphere(0.3);  // the robot is a disc of 0.2 m
  ball.legs = {1};
  Plan plan = plan_and_check({.space = space, .start = start, .goals = {goal, start, goal}, .loads = {ball}});
  give_motion(space, plan, {}, 0.4);
  ASSERT_TRUE(plan.motion) << plan.motion_caveat;
  const PagePlan page = page_of_plan(plan, space, start, "there and back");
  ASSERT_EQ(page.link_poses.size(), plan.motion->motion.positions.size());
  for (std::size_t k = 0; k < page.link_poses.size(); ++k) {
    const Eigen::Vector2d ball_at = page.link_poses[k].back().translation().head<2>();
    const Configuration expected = k < plan.motion->leg_ends[0]   ? goal
                                   : k > plan.motion->leg_ends[1] ? start
                                                                  : plan.motion->motion.positions[k];
    ASSERT_LT((ball_at - expected).norm(), 1e-9) << k;
  }
  ASSERT_EQ(page.clearance.size(), page.link_poses.size());
  int near = 0;
  for (std::size_t k = 0; k < page.clearance.size(); ++k) {
    const Eigen::Vector2d q = plan.motion->motion.positions[k];
    const Eigen::Vector2d beyond(
        (Eigen::Array2d(1.0, -0.6) - q.array()).max(q.array() - Eigen::Array2d(1.1, 0.9)).max(0.0));
    const bool rides = k > plan.motion->leg_ends[0] && k <= plan.motion->leg_ends[1];
    const double truth = beyond.norm() - (rides ? 0.3 : 0.2) - space.options().padding;
    ASSERT_LE(page.clearance[k], truth + 1e-6) << k;
    if (truth > 0.15) continue;
    ++near;
    ASSERT_GE(page.clearance[k], truth - 0.01) << k;
  }
  EXPECT_GT(near, 10);
}

}  // namespace map_page_test
}  // namespace clearway
