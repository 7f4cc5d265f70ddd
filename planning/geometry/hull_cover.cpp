// Spheres that hold a hull.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/farthest_vertex.hpp"

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
  Sphere sphere{Eigen::Vector3d::Zero(), HUGE_VAL};  ///< the smallest so far
  double stands_out = 0.0;                           ///< out of the hull, metres, at most
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of the next sphere
  int steps = 0;                                     ///< that led there

  Eigen::AlignedBox3d box() const {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& corner : corners) box.extend(corner);
    return box;
  }
};

/// Takes so many steps in all towards the middle of the smallest sphere (Badoiu, Clarkson 2003).
void surround(HullPart& part, const HullPlanes& planes, int steps) {
  if (part.steps == 0) part.middle = part.box().center();
  while (part.steps < steps) {
    const Eigen::Vector3d out = part.corners[farthest_from(part.corners, part.middle)] - part.middle;
    if (out.norm() < part.sphere.radius) part.sphere = {part.middle, out.norm()};
    ++part.steps;
    part.middle += out / (part.steps + 1.0);
  }
  part.stands_out = part.sphere.radius - planes.inner_radius(part.sphere.center);
}

/// A plane across an axis, and where it cuts a part.
struct HullCut {
  int axis = 0;
  double at = 0.0;
  std::vector<Eigen::Vector3d> section;  ///< corners, in turn around their middle
  std::array<bool, 2> has_edges{};       ///< the part, below and above

  std::size_t side_of(const Eigen::Vector3d& corner) const { return corner[axis] >= at ? 1 : 0; }
  Eigen::Vector3d crossing(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    Eigen::Vector3d crossing = a + (at - a[axis]) / (b[axis] - a[axis]) * (b - a);
    crossing[axis] = at;
    return crossing;
  }
};

/// Sorts what lies in a plane across the axis by the angle about the middle.
void sort_around_middle(std::vector<Eigen::Vector3d>& corners, int axis) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : corners) middle += corner / static_cast<double>(corners.size());
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<std::pair<double, Eigen::Vector3d>> turned;
  turned.reserve(corners.size());
  for (const Eigen::Vector3d& corner : corners)
    turned.emplace_back(std::atan2(corner[v] - middle[v], corner[u] - middle[u]), corner);
  std::sort(turned.begin(), turned.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::transform(turned.begin(), turned.end(), corners.begin(),
                 [](const auto& entry) { return entry.second; });
}

HullCut cut_across(const HullPart& part, int axis, double at) {
  HullCut cut{axis, at, {}, {}};
  for (const auto& [a, b] : part.edges) {
    const std::size_t side_of_a = cut.side_of(a), side_of_b = cut.side_of(b);
    cut.has_edges[side_of_a] = cut.has_edges[side_of_b] = true;
    if (side_of_a != side_of_b) cut.section.push_back(cut.crossing(a, b));
  }
  sort_around_middle(cut.section, axis);
  return cut;
}

/// The halves below and above the plane, without edges.
std::array<HullPart, 2> halves_of(const HullPart& part, const HullCut& cut) {
  std::array<HullPart, 2> sides;
  for (const Eigen::Vector3d& corner : part.corners) sides[cut.side_of(corner)].corners.push_back(corner);
  for (HullPart& side : sides)
    side.corners.insert(side.corners.end(), cut.section.begin(), cut.section.end());
  return sides;
}

/// Gives the halves their edges; those of the section close both.
void share_edges(const HullPart& part, const HullCut& cut, std::array<HullPart, 2>& sides) {
  for (HullPart& side : sides) side.edges.reserve(part.edges.size() + cut.section.size());
  for (const auto& [a, b] : part.edges) {
    HullPart &side_of_a = sides[cut.side_of(a)], &side_of_b = sides[cut.side_of(b)];
    if (&side_of_a == &side_of_b) {
      side_of_a.edges.emplace_back(a, b);
      continue;
    }
    const Eigen::Vector3d crossing = cut.crossing(a, b);
    side_of_a.edges.emplace_back(a, crossing);
    side_of_b.edges.emplace_back(crossing, b);
  }
  const std::vector<Eigen::Vector3d>& section = cut.section;
  for (std::size_t i = 0; i < section.size(); ++i) {
    for (HullPart& side : sides) side.edges.emplace_back(section[i], section[(i + 1) % section.size()]);
  }
}

/// The halves across that axis whose spheres stand out least; none where the part has no extent.
std::array<HullPart, 2> best_halves(const HullPart& part, const HullPlanes& planes) {
  const Eigen::Vector3d middle = part.box().center();
  std::array<HullPart, 2> best;
  HullCut best_cut;
  double least = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    HullCut cut = cut_across(part, axis, middle[axis]);
    if (!cut.has_edges[0] || !cut.has_edges[1]) continue;
    std::array<HullPart, 2> sides = halves_of(part, cut);
    const bool is_better = std::all_of(sides.begin(), sides.end(), [&](HullPart& side) {
      surround(side, planes, steps_to_compare);
      return side.stands_out < least;
    });
    if (!is_better) continue;
    least = std::max(sides[0].stands_out, sides[1].stands_out);
    best = std::move(sides);
    best_cut = std::move(cut);
  }
  if (best[0].corners.empty()) return best;
  share_edges(part, best_cut, best);
  for (HullPart& side : best) surround(side, planes, steps_to_middle);
  return best;
}

std::vector<Sphere> spheres_around(const std::vector<HullPart>& parts, double margin) {
  std::vector<Sphere> spheres;
  for (const HullPart& part : parts) spheres.push_back({part.sphere.center, part.sphere.radius + margin});
  return spheres;
}

}  // namespace

std::vector<Sphere> hull_cover(const ShapeSurface& hull, std::size_t most) {
  const HullPlanes planes(hull);
  if (!planes.is_known()) return {};
  HullPart whole;
  whole.corners = hull.corners;
  const auto corner = [&](int i) { return hull.corners[static_cast<std::size_t>(i)]; };
  for (const auto& [a, b] : surface_edges(hull)) whole.edges.emplace_back(corner(a), corner(b));
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
    if (halves[0].corners.empty()) return best;
    worst = std::move(halves[0]);
    parts.push_back(std::move(halves[1]));
  }
}

}  // namespace clearway
