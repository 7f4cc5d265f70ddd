// The independent check's search for the nearest blocked voxel, against arithmetic.
#include <gtest/gtest.h>

#include <cmath>

#include "planning/check/path_check_model.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway::check {
namespace path_check_voxels_test {

TEST(PathCheckVoxels, TheNearestIsFoundHoweverFarAwayAndNothingBeyondTheLimit) {
  constexpr double edge = 0.1, radius = 0.2;
  const Eigen::Vector3d voxel(0.05, 0.05, 0.05);
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, voxel);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(12.0);
  const BlockedCells cells(builder.snapshot(), Policy::not_occupied, 0xffff, {-reach, reach}, 0.0);
  Robot robot;
  robot.links.emplace_back();
  robot.bodies.resize(1);
  robot.bodies[0].shape = Shape::sphere(radius);
  const FclBodies bodies(robot);
  Random random(1);
  for (const double limit : {0.05, 0.5, 3.0, 8.0}) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d at = random.unit() * random.point(10.0);
      const double truth = ((at - voxel).cwiseAbs().array() - edge / 2).max(0.0).matrix().norm() - radius;
      const Nearest found =
          nearest_voxel(bodies, 0, Eigen::Isometry3d(Eigen::Translation3d(at)), at, cells, limit);
      ASSERT_NEAR(found.distance, std::clamp(truth, 0.0, limit), 1e-6)
          << at.transpose() << " limit " << limit;
      ASSERT_EQ(found.cube.has_value(), truth < limit) << at.transpose() << " limit " << limit;
      const Nearest hinted =
          nearest_voxel(bodies, 0, Eigen::Isometry3d(Eigen::Translation3d(at)), at, cells, limit, voxel);
      ASSERT_NEAR(hinted.distance, found.distance, 1e-12);
      ASSERT_EQ(hinted.cube.has_value(), truth < limit) << at.transpose() << " limit " << limit;
      ASSERT_LT((found.cube.value_or(voxel) - voxel).norm(), 1e-12);
    }
  }
}

TEST(PathCheckVoxels, AVoxelExactlyAtTheLimitIsBeyondItHintedOrNot) {
  constexpr double edge = 0.1;
  const Eigen::Vector3d voxel(0.05, 0.05, 0.05), at(1.0, 0.05, 0.05), reach = Eigen::Vector3d::Constant(4.0);
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, voxel);
  const BlockedCells cells(builder.snapshot(), Policy::not_occupied, 0xffff, {-reach, reach}, 0.0);
  Robot robot;
  robot.links.emplace_back();
  robot.bodies.resize(1);
  robot.bodies[0].shape = Shape::sphere(0.2);
  const FclBodies bodies(robot);
  const Eigen::Isometry3d pose(Eigen::Translation3d{at});
  const double away = bodies.cube_distance(0, pose, voxel, edge, HUGE_VAL), more = std::nextafter(away, 9.0);
  ASSERT_NEAR(away, 0.7, 1e-6);
  for (const std::optional<Eigen::Vector3d>& hint :
       {std::optional<Eigen::Vector3d>(), std::optional(voxel)}) {
    EXPECT_FALSE(nearest_voxel(bodies, 0, pose, at, cells, away, hint).cube);
    EXPECT_EQ(nearest_voxel(bodies, 0, pose, at, cells, away, hint).distance, away);
    EXPECT_TRUE(nearest_voxel(bodies, 0, pose, at, cells, more, hint).cube);
  }
}

}  // namespace path_check_voxels_test
}  // namespace clearway::check
