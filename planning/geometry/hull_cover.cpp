// Spheres that hold a hull.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "planning/geometry/convex_hull.hpp"

namespace clearway {
namespace {

// Of the hull's longest edge:
constexpr double little = 0.02;          ///< spheres that stand out less stay whole
constexpr double cover_rounding = 2e-6;  ///< no point of the hull is farther outside of its edges' surface
constexpr int steps_to_middle = 40, steps_to_compare = 8;

/// A part of the hull between planes, by its corners and edges, and a sphere around it.
struct HullPart {
  std::vector<Eigen::Vector3d> corners;  ///< each once
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> edges;
  Sphere sphere;
  double stands_out = 0.0;  ///< out of the hull, metres, at most

  Eigen::AlignedBox3d box() const {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& corner : corners) box.extend(corner);
    return box;
  }
};

/// About a point near the middle of the smallest one (Badoiu, Clarkson 2003).
Sphere around_part(const HullPart& part, int steps) {
  Sphere best{part.box().center(), HUGE_VAL};
  Eigen::Vector3d middle = best.center;
  for (int step = 1; step <= steps; ++step) {
    const Eigen::Vector3d* farthest = nullptr;
    double squared = -1.0;
    for (const Eigen::Vector3d& corner : part.corners) {
      const double here = (corner - middle).squaredNorm();
      if (here <= squared) continue;
      squared = here;
      farthest = &corner;
    }
    if (std::sqrt(squared) < best.radius) best = {middle, std::sqrt(squared)};
    middle += (*farthest - middle) / (step + 1.0);
  }
  return best;
}

void surround(HullPart& part, const HullPlanes& planes, int steps) {
  part.sphere = around_part(part, steps);
  part.stands_out = part.sphere.radius - planes.inner_radius(part.sphere.center);
}

/// Below and above the plane across the axis; the section's own edges close both.
std::array<HullPart, 2> halves_of(const HullPart& part, int axis, double at) {
  std::array<HullPart, 2> sides;
  std::vector<Eigen::Vector3d> section;
  for (const Eigen::Vector3d& corner : part.corners) sides[corner[axis] >= at].corners.push_back(corner);
  for (const auto& [a, b] : part.edges) {
    const bool is_a_above = a[axis] >= at, is_b_above = b[axis] >= at;
    if (is_a_above == is_b_above) {
      sides[is_a_above].edges.emplace_back(a, b);
      continue;
    }
    Eigen::Vector3d crossing = a + (at - a[axis]) / (b[axis] - a[axis]) * (b - a);
    crossing[axis] = at;
    section.push_back(crossing);
    sides[is_a_above].edges.emplace_back(a, crossing);
    sides[is_b_above].edges.emplace_back(crossing, b);
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : section) middle += corner / static_cast<double>(section.size());
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto angle = [&](const Eigen::Vector3d& corner) {
    return std::atan2(corner[v] - middle[v], corner[u] - middle[u]);
  };
  std::sort(section.begin(), section.end(),
            [&](const auto& a, const auto& b) { return angle(a) < angle(b); });
  for (HullPart& side : sides) side.corners.insert(side.corners.end(), section.begin(), section.end());
  for (std::size_t i = 0; i < section.size(); ++i) {
    for (HullPart& side : sides) side.edges.emplace_back(section[i], section[(i + 1) % section.size()]);
  }
  return sides;
}

/// The halves across that axis whose spheres stand out least; none where the part has no extent.
std::array<HullPart, 2> best_halves(const HullPart& part, const HullPlanes& planes) {
  const Eigen::AlignedBox3d box = part.box();
  std::array<HullPart, 2> best;
  double least = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    std::array<HullPart, 2> sides = halves_of(part, axis, box.center()[axis]);
    if (sides[0].edges.empty() || sides[1].edges.empty()) continue;
    for (HullPart& side : sides) surround(side, planes, steps_to_compare);
    const double worse = std::max(sides[0].stands_out, sides[1].stands_out);
    if (worse >= least) continue;
    least = worse;
    best = std::move(sides);
  }
  for (HullPart& side : best)
    if (!side.edges.empty()) surround(side, planes, steps_to_middle);
  return best;
}

std::vector<Sphere> spheres_around(const std::vector<HullPart>& parts, double margin) {
  std::vector<Sphere> spheres;
  for (const HullPart& part : parts) spheres.push_back({part.sphere.center, part.sphere.radius + margin});
  return spheres;
}

}  // namespace

std::vector<Sphere> hull_cover(const std::vector<Eigen::Vector3d>& points, std::size_t most) {
  const HullPlanes planes(points);
  if (!planes.is_known()) return {};
  HullPart whole;
  for (const auto& [a, b] : hull_edges(points))
    whole.edges.emplace_back(points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)]);
  if (whole.edges.empty()) return {};
  whole.corners = points;
  const double longest = whole.box().sizes().maxCoeff();
  surround(whole, planes, steps_to_middle);
  std::vector<HullPart> parts{std::move(whole)};
  std::vector<Sphere> best;
  double least = HUGE_VAL;
  for (;;) {
    HullPart& worst = *std::max_element(parts.begin(), parts.end(), [](const HullPart& a, const HullPart& b) {
      return a.stands_out < b.stands_out;
    });
    if (worst.stands_out < least) {
      least = worst.stands_out;
      best = spheres_around(parts, cover_rounding * longest);
    }
    if (parts.size() >= most || least <= little * longest) return best;
    std::array<HullPart, 2> halves = best_halves(worst, planes);
    if (halves[0].edges.empty()) return best;
    worst = std::move(halves[0]);
    parts.push_back(std::move(halves[1]));
  }
}

}  // namespace clearway
