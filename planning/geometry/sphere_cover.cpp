#include <array>
#include <cmath>
#include <numbers>

#include "planning/geometry/shape.hpp"

namespace clearway {
namespace {

constexpr std::size_t max_spheres = 64;
constexpr double capsule_excess = 1.1;   ///< sphere radius over capsule radius
constexpr double rounding = 1.0 + 1e-9;  ///< keeps the union a cover in spite of rounded sums

/// Equal spheres on the axis, from cap to cap.
std::vector<Sphere> capsule_cover(double radius, double length) {
  const double spacing = 2.0 * radius * std::sqrt(capsule_excess * capsule_excess - 1.0);
  const std::size_t gaps = std::min(static_cast<std::size_t>(std::ceil(length / spacing)), max_spheres - 1);
  if (gaps == 0) return {{Eigen::Vector3d::Zero(), radius}};
  const double step = length / static_cast<double>(gaps);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i <= gaps; ++i) {
    spheres.push_back(
        {{0.0, 0.0, -length / 2 + step * static_cast<double>(i)}, std::hypot(radius, step / 2)});
  }
  return spheres;
}

/// The disc slab |z - center| <= half_height as one sphere in the middle and eight around it.
void cover_slab(double radius, double center, double half_height, std::vector<Sphere>& spheres) {
  constexpr int sectors = 8;
  const double half_angle = std::numbers::pi / sectors;
  const double inner_radius = 0.4 * radius;
  spheres.push_back({{0.0, 0.0, center}, std::hypot(inner_radius, half_height)});
  // A sector of the ring inner_radius … radius: the circle about (middle, 0) that holds its corners and its
  // arc.
  const double middle = 0.75 * radius;
  const Eigen::Vector2d outer(radius * std::cos(half_angle) - middle, radius * std::sin(half_angle));
  const Eigen::Vector2d inner(inner_radius * std::cos(half_angle) - middle,
                              inner_radius * std::sin(half_angle));
  const double flat = std::max({outer.norm(), inner.norm(), radius - middle, middle - inner_radius});
  for (int i = 0; i < sectors; ++i) {
    const double angle = 2.0 * half_angle * i;
    spheres.push_back(
        {{middle * std::cos(angle), middle * std::sin(angle), center}, std::hypot(flat, half_height)});
  }
}

/// A thin disc is one sphere, as wide as the disc: tight in its plane. A longer cylinder is spheres on the
/// axis between two end slabs of small spheres, so that no dome of a whole radius sticks out of the ends.
std::vector<Sphere> cylinder_cover(double radius, double length) {
  if (length <= radius / 2) return {{Eigen::Vector3d::Zero(), std::hypot(radius, length / 2)}};
  std::vector<Sphere> spheres;
  const double end = std::min(0.55 * radius, length / 2);
  cover_slab(radius, (length - end) / 2, end / 2, spheres);
  cover_slab(radius, -(length - end) / 2, end / 2, spheres);
  const double between = length - 2 * end;
  if (between > 0.0) {
    const std::size_t count =
        std::min(static_cast<std::size_t>(std::ceil(between / (0.6 * radius))), max_spheres - spheres.size());
    const double step = between / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double z = -between / 2 + step * (static_cast<double>(i) + 0.5);
      spheres.push_back({{0.0, 0.0, z}, std::hypot(radius, step / 2)});
    }
  }
  return spheres;
}

/// Cell counts along the edges, at most max_spheres in all, that keep the cells' diagonal small: the longest
/// cell edge is halved in turn.
std::array<int, 3> cell_counts(const Eigen::Vector3d& edges) {
  std::array<int, 3> counts{1, 1, 1};
  while (true) {
    int longest = 0;
    for (int i = 1; i < 3; ++i) {
      if (edges[i] / counts[static_cast<std::size_t>(i)] >
          edges[longest] / counts[static_cast<std::size_t>(longest)])
        longest = i;
    }
    std::array<int, 3> more = counts;
    ++more[static_cast<std::size_t>(longest)];
    if (static_cast<std::size_t>(more[0] * more[1] * more[2]) > max_spheres) return counts;
    counts = more;
  }
}

/// One sphere around each cell of the box about `center` for which `keep(cell centre, cell edges)`.
template <typename Keep>
std::vector<Sphere> cell_cover(const Eigen::Vector3d& center, const Eigen::Vector3d& edges,
                               const Keep& keep) {
  const std::array<int, 3> counts = cell_counts(edges);
  const Eigen::Vector3d cell(edges.x() / counts[0], edges.y() / counts[1], edges.z() / counts[2]);
  std::vector<Sphere> spheres;
  for (int x = 0; x < counts[0]; ++x) {
    for (int y = 0; y < counts[1]; ++y) {
      for (int z = 0; z < counts[2]; ++z) {
        const Eigen::Vector3d at =
            center - edges / 2 + cell.cwiseProduct(Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5));
        if (keep(at, cell)) spheres.push_back({at, cell.norm() / 2});
      }
    }
  }
  return spheres;
}

}  // namespace

std::vector<Sphere> Shape::sphere_cover() const {
  std::vector<Sphere> spheres;
  switch (kind_) {
    case Kind::sphere:
      spheres = {{Eigen::Vector3d::Zero(), radius_}};
      break;
    case Kind::capsule:
      spheres = capsule_cover(radius_, length_);
      break;
    case Kind::cylinder:
      spheres = cylinder_cover(radius_, length_);
      break;
    case Kind::box:
      spheres = cell_cover(Eigen::Vector3d::Zero(), edges_, [](const auto&, const auto&) { return true; });
      break;
    case Kind::convex:
      spheres =
          cell_cover(box_center_, edges_, [this](const Eigen::Vector3d& at, const Eigen::Vector3d& cell) {
            const Eigen::Isometry3d pose(Eigen::Translation3d{at});
            const double flat = 1e-6 * edges_.maxCoeff() + 1e-12;  // a flat mesh has cells of no height
            return distance(*this, Eigen::Isometry3d::Identity(), box(cell.cwiseMax(flat)), pose, 0.0)
                       .lower <= 0.0;
          });
      for (Sphere& sphere : spheres) sphere.radius = std::max(sphere.radius, 1e-9);
      break;
  }
  for (Sphere& sphere : spheres) sphere.radius *= rounding;
  return spheres;
}

}  // namespace clearway
