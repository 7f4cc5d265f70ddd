// The maps of a pick's legs against what their definitions say of boxes along the axes.
#include "planning/check/pick_maps.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "planning/problem/pick.hpp"
#include "tests/worlds/slide_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway::check {
namespace pick_maps_test {

constexpr double edge = 0.05, padding = 0.002;
constexpr int far = 7;  ///< voxels to each side of the origin, all occupied

/// A carriage that takes a box of 0.2 x 0.1 x 0.15 m, in a block of voxels.
class PickMaps : public ::testing::Test {
 protected:
  PickMaps() {
    pick_.object.name = "box";
    pick_.object.link = "carriage";
    pick_.object.shape = Shape::box(size_);
  }

  /// Calls `look(voxel, its state in the map without the object, and without the object and the layer)`.
  template <class Look>
  void look_at_all(const Eigen::Vector3d& center, const Look& look) {
    pick_.map_from_object.translation() = center;
    const PickToCheck plan{robot_, block_, pick_, Eigen::Isometry3d::Identity(),
                           std::vector<std::vector<Configuration>>(6, {Configuration::Zero(1)})};
    const PickTerms terms(plan, {}, padding, 0.0);
    const Snapshot freed = without_object(terms), bare = without_layer(terms, block_, pick_.map_from_object);
    for (int x = -far; x < far; ++x)
      for (int y = -far; y < far; ++y)
        for (int z = -far; z < far; ++z) {
          const Eigen::Vector3d low = edge * Eigen::Vector3d(x, y, z);
          const Eigen::Vector3d middle = low + Eigen::Vector3d::Constant(edge / 2);
          look(Eigen::AlignedBox3d(low, low + Eigen::Vector3d::Constant(edge)),
               freed.state(middle) != VoxelState::occupied, bare.state(middle) != VoxelState::occupied);
        }
  }

  const Eigen::Vector3d size_{0.2, 0.1, 0.15};
  const Snapshot block_ = VoxelScene{
      edge,
      {box_of(-far * edge, -far* edge, -far* edge, far* edge, far* edge, far* edge)},
      {},
      {}}.snapshot();
  const Robot robot_ = worlds::slide_robot();
  Pick pick_;
};

/// A box whose faces lie on those of voxels: 4 x 2 x 3 are its own, what it only touches is not.
TEST_F(PickMaps, WhatTheObjectOnlyTouchesStays) {
  int own = 0;
  look_at_all({0.0, 0.0, 0.025}, [&](const Eigen::AlignedBox3d& voxel, bool is_freed, bool) {
    const Eigen::AlignedBox3d object = box_of(-0.1, -0.05, -0.05, 0.1, 0.05, 0.1);
    EXPECT_EQ(is_freed, object.contains(voxel.center())) << voxel.center().transpose();
    own += is_freed ? 1 : 0;
  });
  EXPECT_EQ(own, 24);
}

TEST_F(PickMaps, AreAsTheirDefinitionsSayWhereverTheObjectStands) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  for (int trial = 0; trial < 6; ++trial) {
    const Eigen::Vector3d center(place(random), place(random), place(random));
    pick_.margin = trial % 2 == 0 ? 0.0 : 0.03;
    const Eigen::AlignedBox3d object(center - size_ / 2, center + size_ / 2);
    const double wide = layer_reach(edge, padding), plane = object.min().z();
    const Eigen::AlignedBox3d layer(
        object.min() - Eigen::Vector3d::Constant(wide),
        Eigen::Vector3d(object.max().x() + wide, object.max().y() + wide, plane + edge));
    int own = 0, of_layer = 0;
    look_at_all(center, [&](const Eigen::AlignedBox3d& voxel, bool is_freed, bool is_bare) {
      const bool is_near =
          pick_.margin > 0.0 ? object.exteriorDistance(voxel) <= pick_.margin : object.intersects(voxel);
      EXPECT_EQ(is_freed, is_near && voxel.min().z() >= plane) << trial << ": " << voxel.center().transpose();
      EXPECT_EQ(is_bare, layer.contains(voxel)) << trial << ": " << voxel.center().transpose();
      own += is_freed ? 1 : 0;
      of_layer += is_bare ? 1 : 0;
    });
    EXPECT_GT(own, 20);
    EXPECT_GT(of_layer, 10);
  }
}

}  // namespace pick_maps_test
}  // namespace clearway::check
