// The independent check's search for the nearest blocked voxel, against arithmetic.
#include <gtest/gtest.h>

#include <cmath>

#include "planning/check/path_check_model.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway::check {
namespace path_check_voxels_test {

void find_single_voxel(double edge) {
  const double radius = 2 * edge;
  const Eigen::Vector3d voxel = Eigen::Vector3d::Constant(edge / 2);
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, voxel);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(120 * edge);
  const BlockedCells cells(builder.snapshot(), Policy::not_occupied, 0xffff, {-reach, reach}, 0.0);
  Robot robot;
  robot.links.emplace_back();
  robot.bodies.resize(1);
  robot.bodies[0].shape = Shape::sphere(radius);
  const FclBodies bodies(robot);
  Random random(1);
  for (const double edges : {0.5, 5.0, 30.0, 80.0}) {
    const double limit = edges * edge;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d at = random.unit() * random.point(100 * edge);
      const double truth = ((at - voxel).cwiseAbs().array() - edge / 2).max(0.0).matrix().norm() - radius;
      const Nearest found =
          nearest_voxel(bodies, 0, Eigen::Isometry3d(Eigen::Translation3d(at)), at, cells, limit);
      ASSERT_NEAR(found.distance, std::clamp(truth, 0.0, limit), 1e-5 * edge)
          << at.transpose() << " limit " << limit;
      ASSERT_EQ(found.cube.has_value(), truth < limit) << at.transpose() << " limit " << limit;
      const Nearest hinted =
          nearest_voxel(bodies, 0, Eigen::Isometry3d(Eigen::Translation3d(at)), at, cells, limit, voxel);
      ASSERT_NEAR(hinted.distance, found.distance, 1e-12 * edge);
      ASSERT_EQ(hinted.cube.has_value(), truth < limit) << at.transpose() << " limit " << limit;
      ASSERT_LT((found.cube.value_or(voxel) - voxel).norm(), 1e-12);
    }
  }
}

TEST(PathCheckVoxels, TheNearestIsFoundHoweverFarAwayAndNothingBeyondTheLimit) {
  for (const double edge : {0.01, 0.1, 1.0, 4.0}) find_single_voxel(edge);
}

/// A voxel of a box about the origin, so many cells to either side.
Eigen::Vector3i random_cell(Random& random, int half) {
  return {random.below(2 * half) - half, random.below(2 * half) - half, random.below(2 * half) - half};
}

TEST(PathCheckVoxels, OfManyVoxelsTheNearestIsFoundForEveryShape) {
  constexpr double edge = 0.1;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(3.0);
  Robot robot;
  robot.links.emplace_back();
  robot.bodies.resize(4);
  robot.bodies[0].shape = Shape::box({0.1, 0.25, 0.4});
  robot.bodies[1].shape = Shape::cylinder(0.12, 0.6);
  robot.bodies[2].shape = Shape::capsule(0.08, 0.5);
  robot.bodies[3].shape = Shape::sphere(0.2);
  const FclBodies bodies(robot);
  Random random(2);
  for (int trial = 0; trial < 12; ++trial) {
    FreeSpaceMap builder({.resolution = edge});
    std::vector<Eigen::Vector3d> voxels;
    for (int i = 0; i < 1 + 5 * trial; ++i) {
      voxels.emplace_back((random_cell(random, 15).cast<double>().array() + 0.5) * edge);
      occupy(builder, voxels.back());
    }
    const BlockedCells cells(builder.snapshot(), Policy::not_occupied, 0xffff, {-reach, reach}, 0.0);
    for (int i = 0; i < 24; ++i) {
      const std::size_t body = static_cast<std::size_t>(i) % 4;
      const Eigen::Isometry3d pose = random.pose(1.2);
      const double limit = random.between(0.02, 2.0);
      double truth = limit;
      for (const Eigen::Vector3d& voxel : voxels)
        truth = std::min(truth, bodies.cube_distance(body, pose, voxel, edge));
      const std::optional<Eigen::Vector3d> hint = i % 3 == 0 ? std::optional(voxels.front()) : std::nullopt;
      const Nearest found = nearest_voxel(bodies, body, pose, pose.translation(), cells, limit, hint);
      ASSERT_NEAR(found.distance, truth, 1e-6) << trial << " " << i;
      ASSERT_EQ(found.cube.has_value(), truth < limit);
      if (!found.cube) continue;
      ASSERT_NEAR(bodies.cube_distance(body, pose, *found.cube, edge), truth, 1e-6) << trial << " " << i;
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
