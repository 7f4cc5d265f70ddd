// Ray casting against octomap::OcTree::computeRayKeys, cell for cell, with every instruction set.

#include "mapping/scans/ray_cast.hpp"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <set>
#include <tuple>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace ray_cast_test {

using worlds::Dice;
using Cells = std::set<std::tuple<int, int, int>>;

Cells stock_cells(const ScanRays& rays, double resolution) {
  const octomap::OcTree tree(resolution);
  octomap::KeyRay keys;
  Cells cells;
  for (const RayEnd& ray : rays.ends) {
    const octomap::point3d origin(rays.origin.x(), rays.origin.y(), rays.origin.z());
    EXPECT_TRUE(tree.computeRayKeys(origin, {ray.point.x(), ray.point.y(), ray.point.z()}, keys));
    for (const auto& key : keys) cells.emplace(key[0] - 32768, key[1] - 32768, key[2] - 32768);
  }
  return cells;
}

Cells free_cells(ScanGrid& grid) {
  Cells cells;
  for (const ScanTile* tile : grid.tiles()) {
    for (unsigned bit = 0; bit < 32768; ++bit) {
      if ((tile->free[bit >> 6U] >> (bit & 63U) & 1U) == 0) continue;
      const Eigen::Vector3i cell = tile->cell_of(bit);
      cells.emplace(cell.x(), cell.y(), cell.z());
    }
  }
  return cells;
}

void expect_stock_cells(const ScanRays& rays, double resolution, RayWorkspace& workspace) {
  const Cells expected = stock_cells(rays, resolution);
  for (const InstructionSet set : worlds::instruction_sets()) {
    for (const int threads : {1, 2, 3}) {
      ScanGrid grid;
      cast_rays(rays, resolution, threads, set, workspace, grid);
      const Cells got = free_cells(grid);
      for (const auto& [x, y, z] : expected)
        ASSERT_TRUE(got.count({x, y, z}) == 1)
            << x << " " << y << " " << z << " is missing, set " << static_cast<int>(set);
      ASSERT_EQ(got.size(), expected.size())
          << "set " << static_cast<int>(set) << ", " << threads << " threads";
    }
  }
}

TEST(RayCast, RandomRaysPassOctoMapsVoxels) {
  RayWorkspace workspace;
  for (unsigned seed = 0; seed < 30; ++seed) {
    Dice dice(seed);
    ScanRays rays;
    rays.origin = dice.point(1.0).cast<float>();
    const double resolution = dice.uniform(0.01, 0.1), reach = dice.uniform(0.05, 3.0);
    for (int i = dice.whole(1, 200); i > 0; --i)
      rays.ends.push_back({rays.origin + dice.point(reach).cast<float>()});
    expect_stock_cells(rays, resolution, workspace);
  }
}

TEST(RayCast, RaysAlongAxesDiagonalsAndBordersPassOctoMapsVoxels) {
  RayWorkspace workspace;
  for (const double resolution : {0.0625, 0.05, 0.03}) {
    const auto edge = static_cast<float>(resolution);
    for (const float shift : {0.0F, 0.5F, 1.0F, 0.25F}) {
      ScanRays rays;
      rays.origin = Eigen::Vector3f(shift, -2.0F * shift, shift + 1.0F) * edge;
      for (int x = -6; x <= 6; x += 2)
        for (int y = -6; y <= 6; y += 3)
          for (int z = -6; z <= 6; z += 2)
            rays.ends.push_back({rays.origin + 1.5F * edge * Eigen::Vector3f(x, y, z)});
      rays.ends.push_back({rays.origin});
      rays.ends.push_back({rays.origin + Eigen::Vector3f(1e-30F, 0.0F, 0.0F)});
      rays.ends.push_back({rays.origin - Eigen::Vector3f(edge, 1e-20F, 0.0F)});
      expect_stock_cells(rays, resolution, workspace);
    }
  }
}

TEST(RayCast, RaysThatJustTouchTheNextVoxelPassOctoMapsVoxels) {
  RayWorkspace workspace;
  ScanRays rays;  // ends within a rounding of a border: here OctoMap stops by length, not by voxel
  rays.origin = {0.013F, 0.027F, -0.011F};
  Dice dice(5);
  for (int i = 0; i < 3000; ++i) {
    Eigen::Vector3f end = dice.point(2.0).cast<float>();
    for (int axis = 0; axis < 3; ++axis) {
      if (dice.whole(0, 1) == 0) continue;
      end[axis] = static_cast<float>(std::round(end[axis] / 0.05) * 0.05);
      if (dice.whole(0, 1) == 0) end[axis] = std::nextafter(end[axis], 9.0F);
      if (dice.whole(0, 2) == 0) end[axis] = std::nextafter(end[axis], -9.0F);
    }
    rays.ends.push_back({end});
  }
  expect_stock_cells(rays, 0.05, workspace);
}

TEST(RayCast, FewFarRaysPassOctoMapsVoxelsToo) {
  RayWorkspace workspace;
  Dice dice(6);
  ScanRays rays;
  rays.origin = {0.5F, 0.25F, 0.125F};
  for (int i = 0; i < 100; ++i) rays.ends.push_back({dice.point(1.0).cast<float>()});
  for (int i = 0; i < 4; ++i) rays.ends.push_back({dice.point(60.0).cast<float>()});
  expect_stock_cells(rays, 0.01, workspace);
}

/// Few rays in a wide window, of which only what they pass is read; a dense scan shows what they left in it.
TEST(RayCast, TurnsOfALaserPassOctoMapsVoxelsAndLeaveNoMark) {
  RayWorkspace workspace;
  Dice dice(31);
  for (const double tilt : {0.0, 0.01, 0.3}) {
    ScanRays turn{dice.point(1.0).cast<float>(), {}}, dense{turn.origin, {}};
    for (int i = 0; i < 60; ++i) {
      const double angle = i * M_PI / 30.0, range = dice.uniform(0.1, 15.0);
      turn.ends.push_back({turn.origin + (range * Eigen::Vector3d(std::cos(angle), std::sin(angle),
                                                                  tilt * std::sin(3.0 * angle)))
                                             .cast<float>()});
    }
    for (int i = 0; i < 800; ++i) dense.ends.push_back({turn.origin + dice.point(0.8).cast<float>()});
    expect_stock_cells(turn, 0.04, workspace);
    expect_stock_cells(dense, 0.04, workspace);
  }
}

TEST(RayCast, ADepthFramePassesOctoMapsVoxelsOnBothSidesOfTheLargestWindow) {
  RayWorkspace workspace;
  Dice dice(17);
  ScanRays rays{Eigen::Vector3f(0.31F, -0.12F, 1.05F), {}};
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d way(1.0, dice.uniform(-0.6, 0.6), dice.uniform(-0.45, 0.45));
    const double range = i == 0 ? 9.0 : dice.uniform(0.5, 4.0);  // the first fits no window of its own group
    rays.ends.push_back({rays.origin + (range * way).cast<float>()});
  }
  for (const double resolution : {0.012, 0.005}) expect_stock_cells(rays, resolution, workspace);
}

TEST(RayCast, RaysAtTheBordersOfTheTreePassOctoMapsVoxels) {
  RayWorkspace workspace;
  ScanRays rays;
  rays.origin = Eigen::Vector3f::Constant(327.5F);
  Dice dice(7);
  for (int i = 0; i < 50; ++i) rays.ends.push_back({rays.origin - dice.point(1.0).cwiseAbs().cast<float>()});
  rays.ends.push_back({Eigen::Vector3f::Constant(327.67F)});
  expect_stock_cells(rays, 0.01, workspace);
}

TEST(RayCast, AShorterReachFreesTheVoxelsThatTheRayLeavesWithinIt) {
  RayWorkspace workspace;
  const double resolution = 0.05;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Dice dice(seed);
    ScanRays rays;
    rays.origin = dice.point(0.5).cast<float>();
    Cells expected, unclear;
    for (int i = 0; i < 60; ++i) {
      const RayEnd ray{rays.origin + dice.point(2.0).cast<float>(),
                       static_cast<float>(dice.uniform(-0.2, 3.0))};
      rays.ends.push_back(ray);
      ScanRays one{rays.origin, {{ray.point}}};
      const Eigen::Vector3d origin = rays.origin.cast<double>();
      const Eigen::Vector3d direction = (ray.point.cast<double>() - origin).normalized();
      const Eigen::Vector3i first = (origin / resolution).array().floor().cast<int>();
      for (const auto& [x, y, z] : stock_cells(one, resolution)) {
        const Eigen::Array3d corner = Eigen::Array3d(x, y, z) * resolution;
        const Eigen::Array3d far = corner + (direction.array() > 0.0).cast<double>() * resolution;
        const double leaves = ((far - origin.array()) / direction.array()).minCoeff();
        const bool is_first = Eigen::Vector3i(x, y, z) == first;
        if (!is_first && std::abs(leaves - ray.reach) < 1e-5) unclear.emplace(x, y, z);
        if (is_first || leaves <= ray.reach) expected.emplace(x, y, z);
      }
    }
    for (const InstructionSet set : worlds::instruction_sets()) {
      ScanGrid grid;
      cast_rays(rays, resolution, 1, set, workspace, grid);
      Cells got = free_cells(grid), wanted = expected;
      for (const auto& cell : unclear) {
        got.erase(cell);
        wanted.erase(cell);
      }
      ASSERT_TRUE(got == wanted) << static_cast<int>(set);
    }
  }
}

}  // namespace ray_cast_test
}  // namespace clearway
