#include "apps/problem_sets/solid_cells.hpp"

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "apps/suites/suite_cells.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/triangle_cells.hpp"

namespace clearway {
namespace {

constexpr double most_looked_at = 25e6;

double cells_in(const Eigen::AlignedBox3d& box, double edge) {
  return (box.sizes().array() / edge + 2.0).prod();
}

Eigen::AlignedBox3d box_of(const Triangle& triangle) {
  Eigen::AlignedBox3d box(triangle[0]);
  box.extend(triangle[1]);
  box.extend(triangle[2]);
  return box;
}

std::vector<Triangle> placed_triangles(const ForeignSolid& solid) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i + 2 < solid.triangles.size(); i += 3)
    triangles.push_back({solid.map_from_shape * solid.triangles[i],
                         solid.map_from_shape * solid.triangles[i + 1],
                         solid.map_from_shape * solid.triangles[i + 2]});
  return triangles;
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
      count(solid, box_of(triangle));
      visit_cells_met(triangle, resolution, [&](const Eigen::Vector3i& cell) {
        centers.emplace_back((resolution * (cell.cast<double>().array() + 0.5)).matrix().cast<float>());
      });
    }
    cells.push_back(keep_each_once(centers, before));
  }
  return {tree_of_cloud(centers, {resolution, {}, {}}, world.name), {}};
}

}  // namespace clearway
