#include "apps/suite_scans.hpp"

#include <cmath>
#include <numbers>

#include "datasets/surface.hpp"

namespace clearway {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double inside = 1.0 - 1e-9;  ///< rays to an edge itself could pass by it

int pieces(double length, double spacing) {
  return std::max(1, static_cast<int>(std::ceil(length / spacing)));
}

void add_ring(double radius, double z, double spacing, Points& points) {
  const int count = pieces(2.0 * std::numbers::pi * radius, spacing);
  for (int i = 0; i < count; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / count;
    points.emplace_back(radius * std::cos(turn), radius * std::sin(turn), z);
  }
}

/// In the solid's own frame.
Points points_on(const BoxShape& box, double spacing) {
  Points points;
  const Eigen::Vector3d half = inside * box.size / 2;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int us = pieces(box.size[u], spacing), vs = pieces(box.size[v], spacing);
    for (int i = 0; i <= us; ++i) {
      for (int k = 0; k <= vs; ++k) {
        Eigen::Vector3d at = half;
        at[u] *= 2.0 * i / us - 1.0;
        at[v] *= 2.0 * k / vs - 1.0;
        points.push_back(at);
        at[axis] = -at[axis];
        points.push_back(at);
      }
    }
  }
  return points;
}

Points points_on(const CylinderShape& cylinder, double spacing) {
  Points points;
  const double half = inside * cylinder.length / 2, radius = inside * cylinder.radius;
  const int heights = pieces(cylinder.length, spacing), rings = pieces(cylinder.radius, spacing);
  for (int i = 0; i <= heights; ++i) add_ring(radius, half * (2.0 * i / heights - 1.0), spacing, points);
  for (int i = 0; i < rings; ++i) {
    add_ring(radius * i / rings, half, spacing, points);
    add_ring(radius * i / rings, -half, spacing, points);
  }
  return points;
}

Points points_on(const BallShape& ball, double spacing) {
  Points points;
  const int rings = pieces(std::numbers::pi * ball.radius, spacing);
  for (int i = 0; i <= rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    add_ring(inside * ball.radius * std::sin(polar), inside * ball.radius * std::cos(polar), spacing, points);
  }
  return points;
}

/// Where rays that look all around end: a grid on the cube whose faces are `range` away, at most `spacing`
/// from ray to ray. Relative to the sensor.
Points all_around(double range, double spacing) {
  return points_on(BoxShape{Eigen::Vector3d::Constant(2.0 * range)}, spacing);
}

/// Some ray from `from` meets this voxel first: to its middle or, of one that is seen at a slant, near a
/// corner.
bool sees(const BlockedSpace& occupied, const Eigen::Vector3d& from, const Eigen::Vector3d& voxel,
          double resolution) {
  const auto meets = [&](const Eigen::Vector3d& point) {
    const RayHit first = occupied.cast_ray(from, point - from, 0.0);
    return first.hit && (first.voxel - voxel).norm() < 0.5 * resolution;
  };
  if (meets(voxel)) return true;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sides(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    if (meets(voxel + 0.45 * resolution * sides)) return true;
  }
  return false;
}

Scan empty_scan(const Eigen::Vector3d& from) {
  Scan scan;
  scan.sensor = "range";
  scan.map_from_sensor.translation() = from;
  return scan;
}

}  // namespace

std::vector<Eigen::Vector3d> surface_points(const SceneShape& solid, double spacing) {
  Points points = std::visit([&](const auto& shape) { return points_on(shape, spacing); }, solid.geometry);
  for (Eigen::Vector3d& point : points) point = solid.map_from_shape * point;
  return points;
}

Scan scan_solids(const std::vector<SceneShape>& solids, const Eigen::Vector3d& from, double range,
                 double resolution) {
  std::vector<Surface> surfaces(solids.begin(), solids.end());
  std::vector<const Surface*> targets;
  for (const Surface& surface : surfaces) targets.push_back(&surface);
  Scan scan = empty_scan(from);
  for (const SceneShape& solid : solids) {
    for (const Eigen::Vector3d& point : surface_points(solid, resolution / 2)) {
      const Eigen::Vector3d way = (point - from).normalized();
      const Hit hit = cast_ray(targets, from, way).hit;
      if (hit.along <= range) scan.points.push_back((hit.along * way).cast<float>());
    }
  }
  for (const Eigen::Vector3d& point : all_around(range, resolution)) {
    const Eigen::Vector3d way = point.normalized();
    const double along = std::min(cast_ray(targets, from, way).hit.along, 1.5 * range);
    scan.points.push_back((along * way).cast<float>());
  }
  return scan;
}

Scan scan_voxels(const BlockedSpace& occupied, const Eigen::Vector3d& from, double range, double resolution) {
  Scan scan = empty_scan(from);
  const Eigen::AlignedBox3d near(from.array() - range, from.array() + range);
  occupied.visit_surface(near, [&](const Eigen::Vector3d& voxel) {
    if ((voxel - from).norm() <= range && sees(occupied, from, voxel, resolution))
      scan.points.push_back((voxel - from).cast<float>());
    return true;
  });
  for (const Eigen::Vector3d& point : all_around(range, resolution)) {
    const RayHit first = occupied.cast_ray(from, point, 0.0);
    if (first.hit && first.distance < range + resolution) continue;
    scan.points.push_back((1.5 * range * point.normalized()).cast<float>());
  }
  return scan;
}

Scan scan_solids_before(const Scan& still, const std::vector<SceneShape>& solids,
                        const BlockedSpace& occupied, double range, double resolution) {
  const Eigen::Vector3d from = still.map_from_sensor.translation();
  const std::vector<Surface> surfaces(solids.begin(), solids.end());
  std::vector<const Surface*> targets;
  for (const Surface& surface : surfaces) targets.push_back(&surface);
  Scan scan = still;
  for (Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3d way = point.cast<double>().normalized();
    const double along = cast_ray(targets, from, way).hit.along;
    if (along < point.norm()) point = (along * way).cast<float>();
  }
  for (const SceneShape& solid : solids) {
    for (const Eigen::Vector3d& point : surface_points(solid, resolution / 2)) {
      const Eigen::Vector3d way = (point - from).normalized();
      const double along = cast_ray(targets, from, way).hit.along;
      if (along > range) continue;
      const RayHit wall = occupied.cast_ray(from, way, 0.0);
      if (!wall.hit || wall.distance > along) scan.points.push_back((along * way).cast<float>());
    }
  }
  return scan;
}

}  // namespace clearway
