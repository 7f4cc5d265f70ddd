// The independent check's search for the nearest blocked voxel, against arithmetic.
#include <gtest/gtest.h>

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

}  // namespace path_check_voxels_test
}  // namespace clearway::check
