// What the points of a cloud stand for: stated, usual, or of a surface that was thinned.
#include "mapping/files/cloud_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "mapping/files/cloud_spacing.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace cloud_voxels_test {

using Points = std::vector<Eigen::Vector3f>;
using Cell = std::tuple<int, int, int>;

Cell cell_of(const Eigen::Vector3d& point, double edge) {
  const Eigen::Array3i cell = (point.array() / edge).floor().cast<int>();
  return {cell.x(), cell.y(), cell.z()};
}

/// A wavy sheet across a box of a metre's half edge, tilted, with `count` points strewn over it.
Points sheet(Random& random, int count, double tilt) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0);
    points.push_back(Eigen::Vector3d(x, y, tilt * x + 0.1 * std::sin(4.0 * y)).cast<float>());
  }
  return points;
}

/// The mean of the points in each cell, as PCL's VoxelGrid keeps it.
Points thinned(const Points& points, double leaf) {
  std::map<Cell, std::pair<Eigen::Vector3d, int>> sums;
  for (const Eigen::Vector3f& point : points) {
    auto& [sum, count] =
        sums.try_emplace(cell_of(point.cast<double>(), leaf), Eigen::Vector3d::Zero(), 0).first->second;
    sum += point.cast<double>();
    ++count;
  }
  Points kept;
  for (const auto& [cell, sum] : sums) kept.push_back((sum.first / sum.second).cast<float>());
  return kept;
}

/// Whether free voxels lead from above the sheet to below it, over faces, within the box but for its rim.
bool leads_through(const Snapshot& map, double half) {
  const double edge = map.resolution();
  const int reach = static_cast<int>(half / edge);
  std::set<Cell> seen;
  std::queue<Eigen::Vector3i> open;
  open.push({0, 0, reach});
  while (!open.empty()) {
    const Eigen::Vector3i cell = open.front();
    open.pop();
    if (cell.cwiseAbs().maxCoeff() > reach || !seen.insert({cell.x(), cell.y(), cell.z()}).second) continue;
    if (map.state((cell.cast<double>().array() + 0.5) * edge) == VoxelState::occupied) continue;
    if (cell.z() == -reach) return true;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) open.push(cell + side * Eigen::Vector3i::Unit(axis));
  }
  return false;
}

TEST(CloudVoxels, OfAThinnedSurfaceLeaveNoHoles) {
  const TemporaryFolder folder;
  Random random(3);
  for (const double leaf : {0.025, 0.05, 0.15}) {
    for (const double tilt : {0.0, 0.3}) {
      const Points points = thinned(sheet(random, 120'000, tilt), leaf);
      const std::string file = folder.write("thin.pcd", format_pcd(points));
      const Snapshot map = load_map(file);
      EXPECT_GE(map.resolution(), 0.9 * leaf) << leaf << " " << tilt;
      EXPECT_LE(map.resolution(), 1.6 * leaf) << leaf << " " << tilt;
      EXPECT_FALSE(leads_through(map, 0.9)) << leaf << " " << tilt;
      EXPECT_NE(cloud_remark(file, map, false).find("stand for voxels of"), std::string::npos);
      const Snapshot fine = load_map(file, 0.02);  // as it was asked for
      EXPECT_EQ(fine.resolution(), 0.02);
      if (leaf < 0.1) continue;
      EXPECT_TRUE(leads_through(fine, 0.9)) << leaf;
      EXPECT_NE(cloud_remark(file, fine, true).find("touch fewer than four others"), std::string::npos)
          << leaf;
    }
  }
}

TEST(CloudVoxels, OfOtherCloudsAreTheUsualOnes) {
  Random random(4);
  Points strewn, few, lattice;
  for (int i = 0; i < 3000; ++i) strewn.push_back(random.point(1.0).cast<float>());  // single things
  for (int i = 0; i < 20; ++i) few.push_back(Eigen::Vector3f(0.1F * static_cast<float>(i), 0.0F, 0.0F));
  for (int i = 0; i < 2500; ++i)
    lattice.push_back(
        Eigen::Vector3f(0.02F * static_cast<float>(i % 50), 0.02F * static_cast<float>(i / 50), 0.01F));
  EXPECT_FALSE(thinned_spacing(sheet(random, 100'000, 0.2), 0.02));  // dense
  EXPECT_FALSE(thinned_spacing(strewn, 0.02));
  EXPECT_FALSE(thinned_spacing(few, 0.02));
  EXPECT_FALSE(thinned_spacing(lattice, 0.02));
  EXPECT_FALSE(thinned_spacing({}, 0.02));
  const auto apart = thinned_spacing(lattice, 0.013);
  ASSERT_TRUE(apart);
  EXPECT_NEAR(*apart, 0.02, 1e-6);
  EXPECT_TRUE(thinned_spacing(lattice, 0.01));  // of which its step is a multiple
  Points on_a_plane;
  for (int i = 0; i < 2000; ++i)
    on_a_plane.push_back(Eigen::Vector3f(3.0F * static_cast<float>(random.unit()),
                                         3.0F * static_cast<float>(random.unit()), 0.0F));
  EXPECT_FALSE(thinned_spacing(on_a_plane, 0.02));
  const TemporaryFolder folder;
  const std::string file = folder.write("strewn.ply", format_ply(strewn));
  EXPECT_EQ(load_map(file).resolution(), 0.02);
  EXPECT_NE(cloud_remark(file, load_map(file), false).find("touch fewer than four others"),
            std::string::npos);
  const std::string dense = folder.write("dense.ply", format_ply(sheet(random, 100'000, 0.2)));
  EXPECT_EQ(cloud_remark(dense, load_map(dense), false), "");
}

TEST(CloudVoxels, OfAThinnedSurfaceBesideDenseOnesLeaveNoHoles) {
  const TemporaryFolder folder;
  Random random(6);
  for (const double leaf : {0.045, 0.12}) {
    const Points thin = thinned(sheet(random, 120'000, 0.3), leaf);
    Points points = thin;
    for (const Eigen::Vector3f& point : sheet(random, 100'000, 0.2))
      points.push_back(point + Eigen::Vector3f(2.1F, 0.0F, 0.0F));
    const std::string file = folder.write("mixed.pcd", format_pcd(points));
    const Snapshot map = load_map(file);
    EXPECT_EQ(map.resolution(), 0.02) << leaf;
    EXPECT_FALSE(leads_through(map, 0.85)) << leaf;
    EXPECT_TRUE(leads_through(load_map(file, 0.02), 0.85)) << leaf;
    EXPECT_NE(cloud_remark(file, map, false).find("fill the gaps"), std::string::npos) << leaf;
    // What was filled is near a point of the thinned surface.
    for (const Eigen::Vector3f& center : occupied_centers(map.tree(), file)) {
      if (center.x() > 0.9F) continue;
      float apart = 1.0F;
      for (const Eigen::Vector3f& point : thin) apart = std::min(apart, (center - point).norm());
      ASSERT_LE(apart, 1.2 * leaf + 0.02) << center.transpose();
    }
  }
}

TEST(CloudVoxels, OfScatteredPointsAndLinesAreNotFilled) {
  Random random(7);
  Points points = sheet(random, 100'000, 0.0);
  for (int i = 0; i < 1500; ++i)
    points.push_back((random.point(0.8) + Eigen::Vector3d(0.0, 0.0, 1.0)).cast<float>());
  EXPECT_TRUE(thinned_parts(points, 0.02).empty());
  points = sheet(random, 100'000, 0.0);
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 40; ++k)  // rings of a lidar
      points.push_back({0.05F * static_cast<float>(k), 0.3F * static_cast<float>(i), 1.0F});
  EXPECT_TRUE(thinned_parts(points, 0.02).empty());
}

TEST(CloudVoxels, OfAWideThinSurfaceAreLeftWhereMostIsDense) {
  const TemporaryFolder folder;
  const auto cloud = [](int dense) {
    Points points;
    for (int i = 0; i < dense; ++i)
      points.push_back({0.01F * static_cast<float>(i % 300), 0.01F * static_cast<float>(i / 300), 0.0F});
    for (int i = 0; i < 10'000; ++i)
      points.push_back({0.5F * static_cast<float>(i % 100), 0.5F * static_cast<float>(i / 100), 5.0F});
    return points;
  };
  const std::string file = folder.write("wide.pcd", format_pcd(cloud(150'000)));
  const Snapshot map = load_map(file);
  EXPECT_EQ(map.resolution(), 0.02);
  EXPECT_NE(cloud_remark(file, map, false).find("10,000 voxels of 20 mm stand for points so far apart"),
            std::string::npos)
      << cloud_remark(file, map, false);
  const CloudVoxels voxels = voxels_of_cloud("none.pcd", cloud(9'000));
  EXPECT_NEAR(voxels.edge, 0.625, 1.1e-3);
  EXPECT_TRUE(voxels.left.empty());
}

/// A plane through the origin, its points on a grid that is shaken, in a turned frame.
Points shaken_grid(Random& random, double step, double shake, const Eigen::Quaterniond& turn) {
  Points points;
  const int half = static_cast<int>(0.5 / step);
  const Eigen::Vector3d offset = random.point(0.5 * step);
  for (int i = -half; i <= half; ++i)
    for (int k = -half; k <= half; ++k) {
      const Eigen::Vector3d off = shake * step * random.point(1.0);
      points.push_back((turn * (Eigen::Vector3d(i * step, k * step, 0.0) + offset + off)).cast<float>());
    }
  return points;
}

/// As far apart as voxels are wide, or a little less: some voxels of the surface hold none of them.
TEST(CloudVoxels, OfASurfaceWithAPointForAboutEachVoxelLeaveNoHoles) {
  const TemporaryFolder folder;
  Random random(11);
  for (const double step : {0.015, 0.019, 0.02, 0.0205}) {
    for (const double shake : {0.0, 0.05, 0.12}) {
      for (const double tilt : {0.0, 0.25}) {
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(tilt, random.point(1.0).normalized()));
        const std::string file = folder.write("w.pcd", format_pcd(shaken_grid(random, step, shake, turn)));
        EXPECT_FALSE(leads_through(load_map(file), 0.3)) << step << " " << shake << " " << tilt;
        EXPECT_FALSE(leads_through(load_map(file, 0.02), 0.3)) << step << " " << shake << " " << tilt;
      }
    }
  }
  // On the faces of voxels, where rounding puts each on either side.
  for (const double edge : {0.01, 0.02, 0.05, 0.1}) {
    Points points;
    for (int i = -30; i <= 30; ++i)
      for (int k = -30; k <= 30; ++k) points.push_back((edge * Eigen::Vector3d(i, k, 0.13)).cast<float>());
    const Snapshot map = load_map(folder.write("f.ply", format_ply(points)), edge);
    EXPECT_FALSE(leads_through(map, 20 * edge)) << edge;
  }
}

/// Strewn over a plane: from three a voxel on there is no hole, and fewer are told.
TEST(CloudVoxels, OfStrewnPointsLeaveNoHolesOrSaySo) {
  const TemporaryFolder folder;
  Random random(12);
  for (const double density : {0.7, 1.5, 2.0, 3.0, 4.0, 8.0}) {
    Points points;
    for (int i = 0; i < static_cast<int>(density * 8100); ++i)
      points.push_back(
          Eigen::Vector3d(random.between(-0.9, 0.9), random.between(-0.9, 0.9), 0.003).cast<float>());
    const std::string file = folder.write("s.pcd", format_pcd(points));
    const Snapshot map = load_map(file);
    const bool is_told = cloud_remark(file, map, false).find("may have holes") != std::string::npos;
    EXPECT_TRUE(is_told || !leads_through(map, 0.8)) << density;
    EXPECT_TRUE(density > 3.0 || is_told) << density;
    EXPECT_TRUE(density < 8.0 || !is_told) << density;
  }
}

TEST(CloudVoxels, OfAnExportedMapAreItsOwn) {
  const TemporaryFolder folder;
  Random random(5);
  for (const double edge : {0.05, 0.013, 0.1}) {
    FreeSpaceMap map({.resolution = edge});
    for (int i = 0; i < 300; ++i) occupy(map, (random.point(1.0).array() / edge).floor() * edge + 0.5 * edge);
    const Snapshot before = map.snapshot();
    for (const char* name : {"a.pcd", "a.ply"}) {
      export_map(before, folder.path() / name);
      const Snapshot after = load_map(folder.path() / name);
      EXPECT_EQ(after.resolution(), edge);
      EXPECT_EQ(after.counts().occupied, before.counts().occupied);
      for (const Eigen::Vector3f& center : occupied_centers(before.tree(), name))
        EXPECT_EQ(after.state(center.cast<double>()), VoxelState::occupied);
    }
  }
}

}  // namespace cloud_voxels_test
}  // namespace clearway
