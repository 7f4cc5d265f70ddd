#include "datasets/descriptions/suite_strokes.hpp"

#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {
namespace {

std::vector<Eigen::Vector3d> read_points(const YamlFields& fields) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& at : fields.lists_of_numbers("points", within_reach, 3)) points.emplace_back(at.data());
  if (points.empty()) fields.fail("points", "expected at least one point");
  return points;
}

double length(const std::vector<Eigen::Vector3d>& points) {
  double sum = 0;
  for (size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

/// The point that far along the polyline; its end beyond it.
Eigen::Vector3d point_at(const std::vector<Eigen::Vector3d>& points, double along) {
  for (size_t i = 1; i < points.size(); ++i) {
    const double piece = (points[i] - points[i - 1]).norm();
    if (along < piece) return points[i - 1] + along / piece * (points[i] - points[i - 1]);
    along -= piece;
  }
  return points.back();
}

}  // namespace

std::vector<SuiteSphere> spheres_along(const std::vector<Eigen::Vector3d>& points, double radius,
                                       double spacing) {
  std::vector<SuiteSphere> spheres{{points.front(), radius}};
  for (size_t i = 1; i < points.size(); ++i) {
    const int pieces = static_cast<int>(std::ceil((points[i] - points[i - 1]).norm() / spacing));
    for (int k = 1; k <= pieces; ++k)
      spheres.push_back(
          {points[i - 1] + static_cast<double>(k) / pieces * (points[i] - points[i - 1]), radius});
  }
  return spheres;
}

std::vector<SuiteSphere> spheres_about(const std::vector<Eigen::Vector3d>& points, double around,
                                       double smallest_radius, double largest_radius, int count,
                                       std::uint64_t seed) {
  const double whole = length(points);
  const RandomNumbers random(seed, 0);
  std::vector<SuiteSphere> spheres;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
    Eigen::Vector3d aside;
    for (int axis = 0; axis < 3; ++axis)
      aside[axis] = around * (2 * random.uniform(4 * i + static_cast<std::uint64_t>(axis)) - 1);
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 0;
    spheres.push_back({point_at(points, share * whole) + aside,
                       smallest_radius + random.uniform(4 * i + 3) * (largest_radius - smallest_radius)});
  }
  return spheres;
}

std::vector<SuiteSphere> read_spheres(const YamlFields& fields, const std::string& key) {
  std::vector<SuiteSphere> spheres;
  for (const auto& sphere : fields.lists_of_numbers(key, within_reach, 4)) {
    if (sphere[3] < tiny) fields.fail(key, "expected a positive radius as the last number of each ball");
    spheres.push_back({Eigen::Vector3d(sphere.data()), sphere[3]});
  }
  return spheres;
}

std::vector<SuiteSphere> read_suite_stroke(const YamlFields& fields) {
  std::vector<SuiteSphere> spheres;
  if (fields.has("balls") == fields.has("points"))
    fields.fail("balls", "expected either balls, or points of a polyline that balls are painted along");
  if (fields.has("balls")) {
    spheres = read_spheres(fields, "balls");
    if (spheres.empty()) fields.fail("balls", "expected at least one ball");
  } else if (fields.has("around")) {
    const auto radii = fields.numbers("radii", above_zero, 2);
    if (radii[1] < radii[0]) fields.fail("radii", "expected the smallest and then the largest radius");
    spheres = spheres_about(read_points(fields), fields.number("around", not_negative), radii[0], radii[1],
                            fields.integer("count", {1, 100000}), fields.seed("seed", 1));
  } else {
    const auto points = read_points(fields);
    const double radius = fields.number("radius", above_zero);
    const double spacing = fields.number("spacing", above_zero, radius / 3);
    if (length(points) / spacing > 1e5) fields.fail("spacing", "expected at most 100,000 balls in a stroke");
    spheres = spheres_along(points, radius, spacing);
  }
  fields.finish();
  return spheres;
}

}  // namespace clearway
