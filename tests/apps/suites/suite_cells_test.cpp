#include "apps/suites/suite_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace clearway {
namespace suite_cells_test {

using Eigen::Vector3d;

SceneShape solid(const std::variant<BoxShape, CylinderShape, SphereShape>& geometry, const Vector3d& at,
                 const Vector3d& axis, double angle) {
  SceneShape shape;
  shape.geometry = geometry;
  shape.map_from_shape = Eigen::Translation3d(at) * Eigen::AngleAxisd(angle, axis.normalized());
  return shape;
}

/// The point of a solid nearest to `point`, by formulas of the test's own.
Vector3d nearest(const SceneShape& shape, const Vector3d& point) {
  Vector3d p = shape.map_from_shape.inverse() * point;
  if (const auto* box = std::get_if<BoxShape>(&shape.geometry)) {
    p = p.cwiseMax(-box->size / 2).cwiseMin(box->size / 2);
  } else if (const auto* can = std::get_if<CylinderShape>(&shape.geometry)) {
    p.z() = std::clamp(p.z(), -can->length / 2, can->length / 2);
    p.head<2>() *= std::min(1.0, can->radius / p.head<2>().norm());
  } else {
    p *= std::min(1.0, std::get<SphereShape>(shape.geometry).radius / p.norm());
  }
  return shape.map_from_shape * p;
}

enum class Meeting { yes, no, unclear };

/// Projects to and fro between the two convex bodies. They meet when the points come together; they do not
/// when the plane half-way between the points has all of either body on its own side: as the points are
/// projections of each other, it has once they stand still.
Meeting meeting(const SceneShape& shape, const Vector3d& center, double edge) {
  const Vector3d low = center.array() - edge / 2, high = center.array() + edge / 2;
  Vector3d of_cube = center;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d of_shape = nearest(shape, of_cube);
    const Vector3d next = of_shape.cwiseMax(low).cwiseMin(high);
    const double apart = (of_shape - next).norm();
    if (apart < 1e-9) return Meeting::yes;
    if ((next - of_cube).norm() < 1e-7 * apart) return Meeting::no;
    of_cube = next;
  }
  return Meeting::unclear;
}

std::vector<SceneShape> furniture() {
  return {solid(BoxShape{{0.31, 0.123, 0.07}}, {0.1, 0.2, 0.3}, {1, 2, 3}, 0.7),
          solid(BoxShape{{0.5, 0.01, 0.2}}, {-0.4, 0.1, 0.1}, {0, 0, 1}, 0.4),
          solid(CylinderShape{0.06, 0.21}, {0.3, -0.3, 0.2}, {1, 1, 0}, 1.1),
          solid(CylinderShape{0.004, 0.3}, {0.0, -0.4, 0.2}, {1, 0.2, 0}, 0.5),
          solid(SphereShape{0.09}, {-0.2, -0.25, 0.31}, {0, 0, 1}, 0.0),
          solid(SphereShape{0.003}, {-0.2, 0.45, 0.31}, {0, 0, 1}, 0.0)};
}

TEST(SuiteCells, AVoxelIsOccupiedExactlyWhenASolidMeetsIt) {
  const double edge = 0.02;
  int met = 0, unclear = 0, all = 0;
  const std::vector<SceneShape> solids = furniture();
  const Snapshot map = map_of_solids(solids, edge);
  for (double x = -0.75 + edge / 2; x < 0.75; x += edge) {
    for (double y = -0.75 + edge / 2; y < 0.75; y += edge) {
      for (double z = -0.1 + edge / 2; z < 0.6; z += edge, ++all) {
        const Vector3d center = edge * ((Vector3d(x, y, z) / edge).array().floor() + 0.5).matrix();
        Meeting expected = Meeting::no;
        for (const SceneShape& shape : solids) {
          const Meeting one = meeting(shape, center, edge);
          if (one == Meeting::yes || (one == Meeting::unclear && expected == Meeting::no)) expected = one;
        }
        const VoxelState state = map.state(center);
        EXPECT_TRUE(state == VoxelState::occupied || state == VoxelState::unknown);
        met += expected == Meeting::yes;
        unclear += expected == Meeting::unclear;
        if (expected == Meeting::unclear) continue;
        EXPECT_EQ(state == VoxelState::occupied, expected == Meeting::yes) << center.transpose();
      }
    }
  }
  EXPECT_EQ(all, 75 * 75 * 35);
  EXPECT_GT(met, 1500);
  EXPECT_LT(unclear, 20);
}

std::size_t occupied(const Vector3d& low, const Vector3d& high) {
  const SceneShape box = solid(BoxShape{high - low}, (low + high) / 2, Vector3d::UnitZ(), 0.0);
  return map_of_solids({box}, 0.01).counts().occupied;
}

TEST(SuiteCells, WhatASolidOnlyTouchesIsOccupiedToo) {
  EXPECT_EQ(occupied({0.011, 0.011, 0.011}, {0.029, 0.029, 0.029}), 8u);
  EXPECT_EQ(occupied({0.011, 0.011, 0.011}, {0.029, 0.029, 0.030}), 12u);  // a third layer, touched
  EXPECT_EQ(occupied({0.013, 0.013, 0.013}, {0.014, 0.014, 0.014}), 1u);
}

TEST(SuiteCells, AHullMeetsTheCubesThatItsBoxMeets) {
  const SceneShape box = furniture()[0];
  const Vector3d half = std::get<BoxShape>(box.geometry).size / 2;
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                         i & 4 ? half.z() : -half.z());
  const Shape hull = Shape::convex(corners), whole = shape_of(box);
  int met = 0;
  for (int i = 0; i < 20 * 20 * 20; ++i) {
    const Vector3d center =
        box.map_from_shape.translation() + 0.02 * Vector3d(i % 20 - 9.7, i / 20 % 20 - 9.6, i / 400 - 9.5);
    const bool meets = meets_cube(whole, box.map_from_shape, center, 0.02);
    EXPECT_EQ(meets_cube(hull, box.map_from_shape, center, 0.02), meets);
    met += meets;
  }
  EXPECT_GT(met, 300);
  EXPECT_LT(met, 4000);
}

TEST(SuiteCells, AResolutionTooFineForTheSolidsIsRefused) {
  EXPECT_THROW(map_of_solids({solid(SphereShape{0.001}, {5, 0, 0}, {0, 0, 1}, 0.0)}, 1e-4),
               std::invalid_argument);
}

}  // namespace suite_cells_test
}  // namespace clearway
