#include "mapping/scans/scan_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

#include "mapping/scans/cloud_filters.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

void check_size(double value, const char* name, const char* expected = "length >= 0 in metres") {
  if (std::isfinite(value) && value >= 0.0) return;
  throw std::invalid_argument(std::string("scan filter: ") + name + " is " + short_text(value) +
                              ", expected a finite " + expected);
}

void check_filter(const ScanFilter& filter) {
  check_size(filter.min_range, "min_range");
  check_size(filter.max_range, "max_range");
  check_size(filter.thin_to, "thin_to");
  check_size(filter.outlier_deviations, "outlier_deviations", "number >= 0");
  if (filter.outlier_neighbours < 0 || filter.outlier_neighbours > 1000) {
    throw std::invalid_argument("scan filter: outlier_neighbours is " +
                                std::to_string(filter.outlier_neighbours) + ", expected 0 to 1000");
  }
  if (filter.crop.min().hasNaN() || filter.crop.max().hasNaN())
    throw std::invalid_argument("scan filter: a corner of crop is not a number, expected metres");
  for (const Capsule& body : filter.bodies) {
    if (!body.a.allFinite() || !body.b.allFinite()) {
      throw std::invalid_argument(
          "scan filter: a body's axis is not finite, expected metres in the map frame");
    }
    check_size(body.radius, "a body's radius");
  }
}

/// Around all bodies; empty without one.
Eigen::AlignedBox3d box_of(const std::vector<Capsule>& bodies) {
  Eigen::AlignedBox3d box;
  for (const Capsule& body : bodies) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(body.radius * (1.0 + 1e-9) + 1e-9);
    box.extend(body.a.cwiseMin(body.b) - reach);
    box.extend(body.a.cwiseMax(body.b) + reach);
  }
  return box;
}

bool is_outside(const Eigen::Vector3d& point, double range, const ScanFilter& filter) {
  return range < filter.min_range || (!filter.crop.isEmpty() && !filter.crop.contains(point));
}

/// @param box around the bodies
bool is_in_body(const Eigen::Vector3d& point, const ScanFilter& filter, const Eigen::AlignedBox3d& box) {
  return box.contains(point) && std::any_of(filter.bodies.begin(), filter.bodies.end(),
                                            [&](const Capsule& body) { return contains(body, point); });
}

/// The cube of a grid of such cubes about a point: three whole numbers.
std::array<double, 3> cube_of(const Eigen::Vector3f& point, double edge) {
  const Eigen::Array3d cube = (point.cast<double>().array() / edge).floor();
  return {cube.x(), cube.y(), cube.z()};
}

/// Of the points in each cube that holds any the one nearest to their centroid (of equally near ones the
/// first), in their order: a ray to a centroid would go where none was measured.
void thin(std::vector<Eigen::Vector3f>& points, double edge) {
  std::vector<std::pair<std::array<double, 3>, std::size_t>> cubes;
  cubes.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) cubes.emplace_back(cube_of(points[i], edge), i);
  std::sort(cubes.begin(), cubes.end());
  std::vector<std::size_t> kept;
  for (std::size_t begin = 0, end = 0; begin < cubes.size(); begin = end) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (end = begin; end < cubes.size() && cubes[end].first == cubes[begin].first; ++end)
      sum += points[cubes[end].second].cast<double>();
    const Eigen::Vector3d centroid = sum / static_cast<double>(end - begin);
    const auto away = [&](const auto& of) {
      return (points[of.second].template cast<double>() - centroid).squaredNorm();
    };
    kept.push_back(std::min_element(cubes.begin() + static_cast<std::ptrdiff_t>(begin),
                                    cubes.begin() + static_cast<std::ptrdiff_t>(end),
                                    [&](const auto& a, const auto& b) { return away(a) < away(b); })
                       ->second);
  }
  std::sort(kept.begin(), kept.end());
  for (std::size_t i = 0; i < kept.size(); ++i) points[i] = points[kept[i]];
  points.resize(kept.size());
}

/// Drops the points that stand apart from the others. Rays beyond max_range end nowhere and stay.
void drop_outliers(FilteredPoints& scan, const ScanFilter& filter) {
  const double limit = filter.max_range > 0.0 ? filter.max_range : std::numeric_limits<double>::infinity();
  const auto is_hit = [&](const Eigen::Vector3f& point) {
    return (point.cast<double>() - scan.origin).norm() <= limit;
  };
  const auto middle = std::stable_partition(scan.points.begin(), scan.points.end(), is_hit);
  const auto hits = static_cast<std::size_t>(middle - scan.points.begin());
  if (hits <= static_cast<std::size_t>(filter.outlier_neighbours)) return;
  const std::vector<int> kept =
      inliers({scan.points.begin(), middle}, filter.outlier_neighbours, filter.outlier_deviations);
  std::vector<Eigen::Vector3f> points;
  points.reserve(kept.size() + scan.points.size() - hits);
  for (const int index : kept) points.push_back(scan.points[static_cast<std::size_t>(index)]);
  points.insert(points.end(), middle, scan.points.end());
  scan.dropped_filter += scan.points.size() - points.size();
  scan.points = std::move(points);
}

/// The points of a cube whose ray was an outlier are outliers.
void leave_outliers(const std::vector<Eigen::Vector3f>& rays, double edge, FilteredPoints& scan) {
  if (scan.thinned.empty()) return;
  std::set<std::array<double, 3>> dropped;
  for (const Eigen::Vector3f& point : rays) dropped.insert(cube_of(point, edge));
  for (const Eigen::Vector3f& point : scan.points) dropped.erase(cube_of(point, edge));
  std::erase_if(scan.thinned,
                [&](const Eigen::Vector3f& point) { return dropped.contains(cube_of(point, edge)); });
}

}  // namespace

bool contains(const Capsule& capsule, const Eigen::Vector3d& point) {
  const Eigen::Vector3d axis = capsule.b - capsule.a;
  const double length_squared = axis.squaredNorm();
  const double along = length_squared > 0.0 ? axis.dot(point - capsule.a) / length_squared : 0.0;
  const Eigen::Vector3d nearest = capsule.a + std::clamp(along, 0.0, 1.0) * axis;
  return (point - nearest).squaredNorm() <= capsule.radius * capsule.radius;
}

FilteredPoints filter_points(const Scan& scan, const ScanFilter& filter) {
  check_filter(filter);
  const Eigen::AlignedBox3d bodies = box_of(filter.bodies);
  FilteredPoints result;
  result.origin = scan.map_from_sensor.translation();
  result.points.reserve(scan.points.size());
  for (const Eigen::Vector3f& measured : scan.points) {
    const Eigen::Vector3d point = scan.map_from_sensor * measured.cast<double>();
    const Eigen::Vector3f stored = point.cast<float>();  // OctoMap's own precision
    if (!stored.allFinite()) {
      ++result.dropped_invalid;
    } else if (is_outside(point, (point - result.origin).norm(), filter)) {
      ++result.dropped_filter;
    } else if (is_in_body(point, filter, bodies)) {
      ++result.dropped_filter;
      result.in_bodies.push_back(stored);
    } else {
      result.points.push_back(stored);
    }
  }
  if (filter.thin_to > 0.0) {
    result.thinned = result.points;
    thin(result.points, filter.thin_to);
    result.dropped_filter += result.thinned.size() - result.points.size();
    if (result.thinned.size() == result.points.size()) result.thinned.clear();
  }
  if (filter.outlier_neighbours > 0) {
    const std::vector<Eigen::Vector3f> rays = result.thinned.empty() ? result.thinned : result.points;
    drop_outliers(result, filter);
    leave_outliers(rays, filter.thin_to, result);
  }
  return result;
}

}  // namespace clearway
