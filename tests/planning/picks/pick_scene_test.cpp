#include "planning/picks/pick_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace pick_scene_test {

constexpr double edge = 0.02;

/// The voxels that planner and check take out are the object's, by a count of points inside of it.
TEST(PickScene, FreesWhatTheObjectReachesInto) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    Pick pick;
    pick.map_from_object = random.pose(0.5);
    pick.object.shape = i % 2 == 0 ? Shape::box({0.1, 0.07, 0.05}) : Shape::cylinder(0.04, 0.09);
    const double plane = pick.object.shape.bounds(pick.map_from_object).min().z();
    const std::vector<Eigen::Vector3d> voxels = object_voxels(pick, edge);
    const auto is_listed = [&](const Eigen::Vector3d& point) {
      return std::any_of(voxels.begin(), voxels.end(), [&](const Eigen::Vector3d& center) {
        return (point - center).lpNorm<Eigen::Infinity>() <= edge / 2;
      });
    };
    for (const Eigen::Vector3d& center : voxels) {
      EXPECT_GE(center.z() - edge / 2, plane - 2e-6);
      const Eigen::Vector3d inside = pick.map_from_object.inverse() * center;
      EXPECT_LE(pick.object.shape.signed_distance(inside), edge * 0.87);
    }
    for (int k = 0; k < 500; ++k) {
      const Eigen::Vector3d local = random.point(0.06);
      if (pick.object.shape.signed_distance(local) > -1e-3) continue;
      const Eigen::Vector3d point = pick.map_from_object * local;
      const double bottom = std::floor(point.z() / edge) * edge;
      EXPECT_EQ(is_listed(point), bottom >= plane - 1e-6) << i;
    }
  }
}

TEST(PickScene, KnowsTheLayerOnWhichAnObjectStands) {
  const Shape box = Shape::box({0.06, 0.06, 0.1});
  const Eigen::Isometry3d on_border{Eigen::Translation3d(0.01, 0.01, 0.15)};  // the plane is at z = 0.1
  for (const Eigen::Vector3d& center : support_layer(box, on_border, 0.02, 0.001)) {
    EXPECT_TRUE(std::abs(center.z() - 0.09) < 1e-9 || std::abs(center.z() - 0.11) < 1e-9) << center.z();
    EXPECT_LE((center - on_border.translation()).head<2>().lpNorm<Eigen::Infinity>(), 0.03 + 0.021);
  }
  EXPECT_EQ(support_layer(box, on_border, 0.02, 0.001).size(), 2U * 25U);
}

/// A way that is straight in joint space is not quite so for the object: what is no layer keeps its distance.
TEST(PickScene, VoxelsBesideAndBelowTheLayerAreFartherThanThePadding) {
  constexpr double edge = 0.02, padding = 0.001, room = padding + 0.05 * edge - 1e-5;
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    const Shape box = Shape::box({0.03, 0.05, 0.1});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = random.point(0.3);
    const Eigen::AlignedBox3d bounds = box.bounds(pose);
    Eigen::AlignedBox3d layer;
    for (const Eigen::Vector3d& center : support_layer(box, pose, edge, padding))
      layer.extend(Eigen::AlignedBox3d(center.array() - edge / 2, center.array() + edge / 2));
    EXPECT_GE((bounds.min() - layer.min()).minCoeff(), room) << i;
    EXPECT_GE((layer.max() - bounds.max()).head<2>().minCoeff(), room) << i;
  }
}

}  // namespace pick_scene_test
}  // namespace clearway
