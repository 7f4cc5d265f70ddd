#include "apps/suites/suite_world.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/suites/suite_scans.hpp"
#include "mapping/files/map_digest.hpp"

namespace clearway {
namespace suite_world_test {

/// A floor of which a table hides a part, a sphere and a can, seen by two sensors above.
SuiteWorld furnished() {
  SuiteWorld world;
  world.resolution = 0.04;
  const auto add = [&](const char* name, auto geometry, const Eigen::Vector3d& at) {
    SceneShape shape;
    shape.name = name;
    shape.geometry = geometry;
    shape.map_from_shape.translation() = at;
    world.solids.push_back(shape);
  };
  add("floor", BoxShape{{2.0, 2.0, 0.1}}, {0.0, 0.0, -0.037});
  add("table", BoxShape{{0.6, 0.8, 0.05}}, {0.513, 0.0, 0.411});
  add("ball", SphereShape{0.2}, {-0.5, 0.0, 0.301});
  add("can", CylinderShape{0.1, 0.3}, {0.0, 0.613, 0.203});
  world.sensors = {{0.1, 0.2, 1.4}, {-0.9, -0.8, 1.2}};
  world.sensor_range = 3.0;
  return world;
}

/// Distance of a point from the surface of a solid (all of them stand upright), by formulas of the test's
/// own.
double distance_to(const SceneShape& solid, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = point - solid.map_from_shape.translation();
  if (const auto* sphere = std::get_if<SphereShape>(&solid.geometry))
    return std::abs(p.norm() - sphere->radius);
  Eigen::Vector2d out2;
  Eigen::Vector3d out;
  if (const auto* can = std::get_if<CylinderShape>(&solid.geometry)) {
    out2 = {p.head<2>().norm() - can->radius, std::abs(p.z()) - can->length / 2};
    return std::abs(out2.cwiseMax(0.0).norm() + std::min(out2.maxCoeff(), 0.0));
  }
  out = p.cwiseAbs() - std::get<BoxShape>(solid.geometry).size / 2;
  return std::abs(out.cwiseMax(0.0).norm() + std::min(out.maxCoeff(), 0.0));
}

double distance_to(const SuiteWorld& world, const Eigen::Vector3d& point) {
  double least = 1e9;
  for (const SceneShape& solid : world.solids) least = std::min(least, distance_to(solid, point));
  return least;
}

/// Inside of a solid, by the same formulas.
bool is_inside(const SceneShape& solid, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = point - solid.map_from_shape.translation();
  if (const auto* sphere = std::get_if<SphereShape>(&solid.geometry)) return p.norm() < sphere->radius;
  if (const auto* can = std::get_if<CylinderShape>(&solid.geometry))
    return p.head<2>().norm() < can->radius && std::abs(p.z()) < can->length / 2;
  return ((p.cwiseAbs() - std::get<BoxShape>(solid.geometry).size / 2).array() < 0.0).all();
}

/// Whether nothing lies between, by walking along.
bool sees(const SuiteWorld& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const int steps = static_cast<int>((to - from).norm() / 0.002);
  for (int i = 0; i < steps - 1; ++i)
    for (const SceneShape& solid : world.solids)
      if (is_inside(solid, from + static_cast<double>(i) / steps * (to - from))) return false;
  return true;
}

TEST(SuiteWorld, OccupiedVoxelsHoldASurface) {
  const SuiteWorld world = furnished();
  const double half_diagonal = world.resolution * std::sqrt(3.0) / 2.0;
  std::size_t occupied = 0;
  make_map(world, {}).visit_leaves([&](const Voxel& voxel) {
    if (voxel.state != VoxelState::occupied) return;
    const int across = static_cast<int>(std::lround(voxel.size / world.resolution));
    for (int i = 0; i < across * across * across; ++i, ++occupied) {
      const Eigen::Vector3d cell(i % across, i / across % across, i / across / across);
      const Eigen::Vector3d center =
          voxel.center + ((cell.array() + 0.5) * world.resolution - voxel.size / 2).matrix();
      EXPECT_LE(distance_to(world, center), half_diagonal + 1e-5) << center.transpose();
    }
  });
  EXPECT_GT(occupied, 3000u);
}

TEST(SuiteWorld, WhatASensorSeesOfASurfaceIsOccupied) {
  const SuiteWorld world = furnished();
  const Snapshot map = make_map(world, {});
  int seen = 0, hidden_free = 0;
  for (const SceneShape& solid : world.solids) {
    const auto points = surface_points(solid, 0.013);  // not the density of the rays
    for (std::size_t i = 0; i < points.size(); i += 17) {
      const bool visible = std::any_of(world.sensors.begin(), world.sensors.end(),
                                       [&](const auto& sensor) { return sees(world, sensor, points[i]); });
      if (!visible) continue;
      ++seen;
      bool near = false;  // the voxel of the point, or one that its surface cuts more than a corner of
      for (int k = 0; k < 7; ++k) {
        Eigen::Vector3d at = points[i];
        if (k < 6) at[k / 2] += (k % 2 == 0 ? -0.5 : 0.5) * world.resolution;
        near = near || map.state(at) == VoxelState::occupied;
      }
      EXPECT_TRUE(near) << solid.name << " at " << points[i].transpose();
      if (map.state(points[i]) != VoxelState::occupied) ++hidden_free;
    }
  }
  EXPECT_GT(seen, 1500);
  EXPECT_LT(hidden_free, seen / 50);
}

TEST(SuiteWorld, SpaceThatRaysPassIsFreeAndWhatSolidsHideIsUnknown) {
  const Snapshot map = make_map(furnished(), {});
  EXPECT_EQ(map.state({0.0, 0.0, 0.8}), VoxelState::seen_free);
  EXPECT_EQ(map.state({-0.5, -0.5, 0.3}), VoxelState::seen_free);
  EXPECT_EQ(map.state({-0.5, 0.0, 0.3}), VoxelState::unknown);    // in the sphere
  EXPECT_EQ(map.state({0.6, -0.05, 0.36}), VoxelState::unknown);  // under the table
  EXPECT_EQ(map.state({0.0, 0.0, -0.6}), VoxelState::unknown);    // under the floor
}

TEST(SuiteWorld, SurfacePointsLieOnTheSurfaceAndLeaveNoGap) {
  for (const SceneShape& solid : furnished().solids) {
    const auto points = surface_points(solid, 0.04);
    for (const Eigen::Vector3d& point : points) ASSERT_LT(distance_to(solid, point), 1e-8) << solid.name;
    for (const Eigen::Vector3d& other : surface_points(solid, 0.027)) {
      double least = 1e9;
      for (const Eigen::Vector3d& point : points) least = std::min(least, (point - other).norm());
      ASSERT_LE(least, 0.04) << solid.name;
    }
  }
}

TEST(SuiteWorld, PaintIsPaintedStrokeByStrokeAndSpheresThatMeetAPocketAreLeftOut) {
  SuiteWorld world;
  world.resolution = 0.02;
  world.volumes = {{"a", {"hand"}, {{{{0, 0, 0}, 0.1}, {{0.1, 0, 0}, 0.1}}, {{{0.32, 0, 0}, 0.1}}}},
                   {"b", {}, {{{{0, 1, 0}, 0.1}}}}};
  world.pockets = {{{0.2, 0.0, 0.0}, 0.015}};
  const Snapshot map = make_map(world, {"tool"});
  ASSERT_EQ(map.volumes().size(), 2u);
  const PaintedVolume& a = map.volumes()[0];
  EXPECT_EQ(a.label, "a");
  EXPECT_EQ(a.critical_parts, std::vector<std::string>{"hand"});
  EXPECT_EQ(map.volumes()[1].critical_parts, std::vector<std::string>{"tool"});
  ASSERT_EQ(a.spheres.size(), 2u);
  EXPECT_EQ(a.spheres[1].center, Eigen::Vector3d(0.32, 0, 0));
  EXPECT_NE(a.stroke_of.at(0), a.stroke_of.at(1));
  EXPECT_EQ(map.state({0.05, 0, 0}), VoxelState::painted);
  EXPECT_EQ(map.state({0.17, 0, 0}), VoxelState::unknown);
  EXPECT_EQ(map.state({0.32, 0, 0}), VoxelState::painted);
}

TEST(SuiteWorld, TheSameWorldMakesTheSameMap) {
  SuiteWorld world = furnished();
  world.volumes = {{"a", {}, {{{{0, 0, 0.5}, 0.1}}}}};
  EXPECT_EQ(map_sha256(make_map(world, {})), map_sha256(make_map(world, {})));
}

}  // namespace suite_world_test
}  // namespace clearway
