#include "apps/problem_sets/solid_cells.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "apps/suites/suite_cells.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double most_looked_at = 25e6;

double cells_in(const Eigen::AlignedBox3d& box, double edge) {
  return (box.sizes().array() / edge + 2.0).prod();
}

struct Triangle {
  Eigen::Vector3d a, b, c;
  Eigen::AlignedBox3d box() const {
    Eigen::AlignedBox3d box(a);
    box.extend(b);
    box.extend(c);
    return box;
  }
};

std::vector<Triangle> placed_triangles(const ForeignSolid& solid) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i + 2 < solid.triangles.size(); i += 3)
    triangles.push_back({solid.map_from_shape * solid.triangles[i],
                         solid.map_from_shape * solid.triangles[i + 1],
                         solid.map_from_shape * solid.triangles[i + 2]});
  return triangles;
}

void append_triangle_cells(const Triangle& triangle, double edge, std::vector<Eigen::Vector3f>& centers) {
  const Eigen::AlignedBox3d box = triangle.box();
  const Eigen::Array3d first = (box.min().array() / edge - 1e-6).floor();
  const Eigen::Array3d last = (box.max().array() / edge + 1e-6).floor();
  for (double z = first.z(); z <= last.z(); ++z)
    for (double y = first.y(); y <= last.y(); ++y)
      for (double x = first.x(); x <= last.x(); ++x) {
        const Eigen::Vector3d center = edge * (Eigen::Vector3d(x, y, z).array() + 0.5).matrix();
        if (triangle_meets_cube(triangle.a, triangle.b, triangle.c, center, edge))
          centers.push_back(center.cast<float>());
      }
}

/// Of the cells from `first` on, which several pieces of one solid may meet; returns how many they are.
std::size_t keep_each_once(std::vector<Eigen::Vector3f>& centers, std::size_t first) {
  const auto begin = centers.begin() + static_cast<std::ptrdiff_t>(first);
  const auto key = [](const Eigen::Vector3f& cell) { return std::tuple(cell.x(), cell.y(), cell.z()); };
  std::sort(begin, centers.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  centers.erase(std::unique(begin, centers.end()), centers.end());
  return centers.size() - first;
}

}  // namespace

bool triangle_meets_cube(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                         const Eigen::Vector3d& center, double edge) {
  const Eigen::Vector3d corners[] = {a - center, b - center, c - center};
  const double half = 0.5 * edge;
  const auto is_apart = [&](const Eigen::Vector3d& axis) {
    const double length = axis.lpNorm<1>();
    if (length == 0.0) return false;
    double low = HUGE_VAL, high = -HUGE_VAL, size = half;
    for (const Eigen::Vector3d& corner : corners) {
      const double at = axis.dot(corner);
      low = std::min(low, at);
      high = std::max(high, at);
      size = std::max(size, corner.lpNorm<Eigen::Infinity>());
    }
    const double reach = half * length + 1e-10 * size * length;
    return low > reach || high < -reach;
  };
  const Eigen::Vector3d sides[] = {b - a, c - b, a - c};
  if (is_apart(sides[0].cross(sides[1]))) return false;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
    if (is_apart(axis)) return false;
    for (const Eigen::Vector3d& side : sides)
      if (is_apart(axis.cross(side))) return false;
  }
  return true;
}

Snapshot map_of_foreign_world(const ForeignWorld& world, double resolution, std::vector<std::size_t>& cells) {
  std::vector<Eigen::Vector3f> centers;
  double looked_at = 0.0;
  const auto count = [&](const ForeignSolid& solid, const Eigen::AlignedBox3d& box) {
    looked_at += cells_in(box, resolution);
    if (looked_at > most_looked_at)
      throw std::invalid_argument("world " + quote(world.name) + ", object " + quote(solid.object) +
                                  ": more than 25000000 voxels would have to be looked at, expected fewer: "
                                  "--resolution makes them larger");
  };
  for (const ForeignSolid& solid : world.solids) {
    if (world.touched.contains(solid.object)) {
      cells.push_back(0);
      continue;
    }
    const std::size_t before = centers.size();
    for (const ForeignCube& cube : solid.cubes) {  // smaller by a hair, as they do not touch their neighbours
      const Shape box = Shape::box(Eigen::Vector3d::Constant((1.0 - 1e-5) * cube.edge));
      const Eigen::Isometry3d map_from_cube = solid.map_from_shape * Eigen::Translation3d(cube.center);
      count(solid, box.bounds(map_from_cube));
      append_cells(box, map_from_cube, resolution, centers);
    }
    if (solid.triangles.empty() && solid.cubes.empty() && solid.kind != "octomap") {
      count(solid, solid.shape.bounds(solid.map_from_shape));
      append_cells(solid.shape, solid.map_from_shape, resolution, centers);
    }
    for (const Triangle& triangle : placed_triangles(solid)) {
      count(solid, triangle.box());
      append_triangle_cells(triangle, resolution, centers);
    }
    cells.push_back(keep_each_once(centers, before));
  }
  return {tree_of_cloud(centers, {resolution, {}, {}}, world.name), {}};
}

}  // namespace clearway
