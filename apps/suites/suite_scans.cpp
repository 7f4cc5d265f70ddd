#include "apps/suites/suite_scans.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/simulation/surface.hpp"

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

Points points_on(const SphereShape& sphere, double spacing) {
  Points points;
  const int rings = pieces(std::numbers::pi * sphere.radius, spacing);
  for (int i = 0; i <= rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    add_ring(inside * sphere.radius * std::sin(polar), inside * sphere.radius * std::cos(polar), spacing,
             points);
  }
  return points;
}

/// Where rays that look all around end: a grid on the cube whose faces are `range` away, at most `spacing`
/// from ray to ray. Relative to the sensor.
Points all_around(double range, double spacing) {
  return points_on(BoxShape{Eigen::Vector3d::Constant(2.0 * range)}, spacing);
}

/// Whether a ray from `from` to the middle of a voxel passes through no other one that is occupied: else it
/// would carve what stands there.
bool is_clear_way(const BlockedSpace& occupied, const Eigen::Vector3d& from, const Eigen::Vector3d& end) {
  const Eigen::Vector3d way = end - from;
  const RayHit first = occupied.cast_ray(from, way, 0.0);
  const double half = 0.5 * occupied.resolution();
  if (!first.hit || (first.voxel - end).norm() < half) return true;
  double entry = 0.0;  // share of the way at which the ray comes into it
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0.0) continue;
    const double side = way[axis] > 0.0 ? -half : half;
    entry = std::max(entry, (first.voxel[axis] + side - from[axis]) / way[axis]);
  }
  return entry >= 1.0;
}

Scan empty_scan(const Eigen::Vector3d& from) {
  Scan scan;
  scan.sensor = "range";
  scan.map_from_sensor.translation() = from;
  return scan;
}

}  // namespace

Eigen::Vector3d voxel_middle(const Eigen::Vector3d& point, double resolution) {
  return ((point / resolution).array().floor() + 0.5) * resolution;
}

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

Scan scan_voxels(const BlockedSpace& occupied, const Eigen::Vector3d& sensor, double range,
                 double resolution) {
  // From a place on the planes between voxels rays run along edges, where it is undefined which voxel they
  // cross.
  const Eigen::Vector3d from = sensor + resolution * Eigen::Vector3d(1.3e-3, 0.7e-3, 1.9e-3);
  Scan scan = empty_scan(from);
  const auto add = [&](const Eigen::Vector3d& end) {
    const bool is_clear = is_clear_way(occupied, from, end);
    if (is_clear) scan.points.push_back((end - from).cast<float>());
    return is_clear;
  };
  // A voxel whose middle others hide may show a face: a table top at a flat angle does.
  const auto add_voxel = [&](const Eigen::Vector3d& voxel) {
    if (add(voxel)) return;
    for (int axis = 0; axis < 3; ++axis) {
      const double side = from[axis] - voxel[axis];
      Eigen::Vector3d face = voxel;
      face[axis] += std::copysign(0.45 * resolution, side);
      if (std::abs(side) > 0.5 * resolution && add(face)) return;
    }
  };
  const Eigen::AlignedBox3d near(from.array() - range, from.array() + range);
  occupied.visit_surface(near, [&](const Eigen::Vector3d& voxel) {
    if ((voxel - from).norm() <= range) add_voxel(voxel);
    return true;
  });
  for (const Eigen::Vector3d& point : all_around(range, resolution)) {
    const Eigen::Vector3d end = voxel_middle(from + 1.5 * range * point.normalized(), resolution);
    const RayHit first = occupied.cast_ray(from, end - from, 0.0);
    if (first.hit && first.distance < range + resolution) continue;
    scan.points.push_back((end - from).cast<float>());
  }
  return scan;
}

SolidScan scan_solids_before(const Scan& still, const std::vector<SceneShape>& solids,
                             const BlockedSpace& occupied, double range, double resolution) {
  const Eigen::Vector3d from = still.map_from_sensor.translation();
  const std::vector<Surface> surfaces(solids.begin(), solids.end());
  std::vector<const Surface*> targets;
  for (const Surface& surface : surfaces) targets.push_back(&surface);
  SolidScan found{empty_scan(from), 0};
  std::vector<Eigen::Vector3f>& points = found.scan.points;
  const auto add = [&](const Eigen::Vector3d& point) {  // of a solid
    const Eigen::Vector3d end = voxel_middle(from + point, resolution);
    if (is_clear_way(occupied, from, end)) points.push_back((end - from).cast<float>());
  };
  std::vector<Eigen::Vector3f> beside;
  for (const Eigen::Vector3f& point : still.points) {
    const Eigen::Vector3d way = point.cast<double>().normalized();
    const double along = cast_ray(targets, from, way).hit.along;
    if (along < point.norm())
      add(along * way);
    else
      beside.push_back(point);
  }
  for (const SceneShape& solid : solids) {
    for (const Eigen::Vector3d& point : surface_points(solid, resolution / 2)) {
      const Eigen::Vector3d way = (point - from).normalized();
      const double along = cast_ray(targets, from, way).hit.along;
      if (along <= range) add(along * way);
    }
  }
  const auto is_before = [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(points.begin(), points.end(), is_before);  // one ray to each voxel is enough
  points.erase(std::unique(points.begin(), points.end()), points.end());
  found.on_solids = points.size();
  points.insert(points.end(), beside.begin(), beside.end());
  return found;
}

}  // namespace clearway
