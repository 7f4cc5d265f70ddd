#include "apps/suites/suite_cells.hpp"

#include <cmath>

#include "mapping/files/cloud_file.hpp"

namespace clearway {

void append_cells(const Shape& body, const Eigen::Isometry3d& map_from_body, double edge,
                  std::vector<Eigen::Vector3f>& centers) {
  const Eigen::AlignedBox3d box = body.bounds(map_from_body);
  const Eigen::Array3d first = (box.min().array() / edge - 1e-6).floor();
  const Eigen::Array3d last = (box.max().array() / edge + 1e-6).floor();
  for (double z = first.z(); z <= last.z(); ++z) {
    for (double y = first.y(); y <= last.y(); ++y) {
      for (double x = first.x(); x <= last.x(); ++x) {
        const Eigen::Vector3d center = edge * (Eigen::Vector3d(x, y, z).array() + 0.5).matrix();
        if (meets_cube(body, map_from_body, center, edge)) centers.push_back(center.cast<float>());
      }
    }
  }
}

Shape shape_of(const SceneShape& solid) {
  if (const auto* box = std::get_if<BoxShape>(&solid.geometry)) return Shape::box(box->size);
  if (const auto* cylinder = std::get_if<CylinderShape>(&solid.geometry))
    return Shape::cylinder(cylinder->radius, cylinder->length);
  return Shape::sphere(std::get<SphereShape>(solid.geometry).radius);
}

bool meets_cube(const Shape& body, const Eigen::Isometry3d& map_from_body, const Eigen::Vector3d& center,
                double edge) {
  // Most cubes are decided by the largest sphere inside, or by the smallest about them.
  const Eigen::Vector3d in_body = map_from_body.inverse() * center;
  const double apart = body.signed_distance(in_body);  // of a hull: from the box around it
  if (apart > 0.5 * std::sqrt(3.0) * edge * (1.0 + 1e-9)) return false;
  if (body.has_exact_distance() && apart <= 0.5 * edge) return true;
  return distance_to_cube(body, map_from_body, center, edge).lower <= 0.0;
}

Snapshot map_of_solids(const std::vector<SceneShape>& solids, double resolution) {
  std::vector<Eigen::Vector3f> centers;
  for (const SceneShape& solid : solids)
    append_cells(shape_of(solid), solid.map_from_shape, resolution, centers);
  return {tree_of_cloud(centers, {resolution, {}, {}}, "solids"), {}};
}

}  // namespace clearway
