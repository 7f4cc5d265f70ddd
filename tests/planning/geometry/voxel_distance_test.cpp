#include "planning/geometry/voxel_distance.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace cube_gap_test {

std::vector<Shape> every_kind() {
  return {Shape::sphere(0.07), Shape::capsule(0.05, 0.3), Shape::cylinder(0.06, 0.15),
          Shape::box({0.1, 0.3, 0.06}),
          Shape::convex({{0, 0, 0}, {0.2, 0, 0}, {0, 0.1, 0}, {0.05, 0.05, 0.2}})};
}

VoxelDistance distance_to(const VoxelDistances& distances, const NearVoxel& cube, double enough) {
  VoxelDistance to_voxel;
  distances.to(std::span(&cube, 1), enough, std::span(&to_voxel, 1));
  return to_voxel;
}

TEST(VoxelDistance, IsWhatGjkProvesAndNeverMore) {
  Random random(3);
  for (const Shape& shape : every_kind()) {
    int apart = 0;
    double short_by = 0.0;
    for (int trial = 0; trial < 3000; ++trial) {
      const Eigen::Isometry3d pose = random.pose(0.2);
      const Eigen::Vector3d cube = random.point(0.3);
      const VoxelDistance to_voxel =
          distance_to(VoxelDistances(shape, pose, 0.05), {cube, pose.translation()}, 1.0);
      const DistanceBounds bounds = distance_to_cube(shape, pose, cube, 0.05);
      EXPECT_LE(to_voxel.distance, bounds.upper + 1e-12);
      const bool has_faces = shape.kind() == Shape::Kind::cylinder || shape.kind() == Shape::Kind::box;
      EXPECT_GE(to_voxel.distance, bounds.lower - (has_faces ? 0.01 * 0.05 : 1e-9));
      short_by += std::max(0.0, bounds.lower - to_voxel.distance);
      if (bounds.lower < 5e-3) continue;
      ++apart;
      EXPECT_NEAR(to_voxel.normal.norm(), 1.0, 1e-12);
      // The plane through the point has the whole body behind it.
      const Eigen::Vector3d farthest = pose * shape.support(pose.linear().transpose() * to_voxel.normal);
      EXPECT_LE(to_voxel.normal.dot(farthest - to_voxel.point), 1e-9);
    }
    EXPECT_GT(apart, 1000);
    EXPECT_LT(short_by / 3000, 2e-5);
  }
}

/// Each among others, at every place of a row of them, has the bits that it has alone.
TEST(VoxelDistance, IsTheSameWhateverOtherCubesAndRegistersThereAre) {
  Random random(4);
  for (const Shape& shape : every_kind()) {
    for (int trial = 0; trial < 300; ++trial) {
      const VoxelDistances distances(shape, random.pose(0.2), 0.05);
      std::vector<NearVoxel> cubes(static_cast<std::size_t>(1 + trial % 11));
      for (NearVoxel& cube : cubes) cube = {random.point(0.3), random.point(0.2)};
      std::vector<VoxelDistance> together(cubes.size());
      distances.to(cubes, 0.1, together);
      for (const InstructionSet vectors : worlds::instruction_sets()) {
        std::vector<VoxelDistance> same(cubes.size());
        distances.to(cubes, 0.1, same, vectors);
        for (std::size_t i = 0; i < cubes.size(); ++i) {
          EXPECT_EQ(same[i].distance, together[i].distance);
          EXPECT_EQ(same[i].point, together[i].point);
          EXPECT_EQ(same[i].normal, together[i].normal);
        }
      }
      for (std::size_t i = 0; i < cubes.size(); ++i) {
        const VoxelDistance alone = distance_to(distances, cubes[i], 0.1);
        EXPECT_EQ(alone.distance, together[i].distance);
        EXPECT_EQ(alone.point, together[i].point);
        EXPECT_EQ(alone.normal, together[i].normal);
      }
    }
  }
}

TEST(VoxelDistance, OfWhatOverlapsIsZeroAndItsDirectionIsNoneOrThatOfTheirLastTouch) {
  Random random(5);
  for (const Shape& shape : every_kind()) {
    int undirected = 0;
    for (int trial = 0; trial < 300; ++trial) {
      const Eigen::Isometry3d pose = random.pose(0.2);
      const Eigen::Vector3d inside = shape.kind() == Shape::Kind::convex ? Eigen::Vector3d(0.05, 0.03, 0.05)
                                                                         : Eigen::Vector3d(0.01, 0.02, 0.02);
      const Eigen::Vector3d cube = pose * inside + random.point(0.02);
      const VoxelDistance to_voxel =
          distance_to(VoxelDistances(shape, pose, 0.05), {cube, pose * random.point(0.1)}, 1.0);
      EXPECT_EQ(to_voxel.distance, 0.0);
      undirected += to_voxel.normal == Eigen::Vector3d(0.0, 0.0, 0.0) ? 1 : 0;
      if (to_voxel.normal != Eigen::Vector3d(0.0, 0.0, 0.0)) {
        EXPECT_NEAR(to_voxel.normal.norm(), 1.0, 1e-12);
        EXPECT_LT((to_voxel.point - cube).cwiseAbs().maxCoeff(), 0.025 + 1e-3);
      }
    }
    EXPECT_GT(undirected, 0) << static_cast<int>(shape.kind());
  }
}

/// Halves and quarters, which nothing rounds: here what is kept back for rounding is all that is missing.
TEST(VoxelDistance, IsNoMoreThanTheExactOneWhereNothingIsRoundedHoweverLargeTheVoxel) {
  for (const double edge : {0.0625, 0.5, 4.0, 64.0})
    for (const double radius : {0.015625, 0.125})
      for (const Eigen::Vector3d& way : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, -1)}) {
        const double gap = radius;
        const Eigen::Isometry3d pose(Eigen::Translation3d((0.5 * edge + radius + gap) * way));
        for (const Shape& shape : {Shape::sphere(radius), Shape::capsule(radius, 0.5)}) {
          if (shape.length() > 0.0 && way.z() != 0.0) continue;  // the capsule lies along the face
          const VoxelDistance found = distance_to(VoxelDistances(shape, pose, edge),
                                                  {Eigen::Vector3d::Zero(), pose.translation()}, 1e3);
          EXPECT_LE(found.distance, gap) << edge << " " << radius;
          EXPECT_GE(found.distance, gap - 1e-11 * (1.0 + edge)) << edge << " " << radius;
        }
      }
}

}  // namespace cube_gap_test
}  // namespace clearway
