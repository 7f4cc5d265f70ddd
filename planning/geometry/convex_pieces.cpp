#include "planning/geometry/convex_pieces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "planning/geometry/convex_hull.hpp"

namespace clearway {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr int cuts_of_an_axis = 5;
constexpr double least_gain = 0.01;          ///< of the first hulls' volume; less is not worth a hull
constexpr std::size_t most_judged = 20'000;  ///< triangles by which a cut is judged
constexpr std::size_t most_points = 20'000;  ///< of these, by which a volume is
constexpr std::size_t directions_to_judge = 80;
constexpr double largest_hole = 0.2;  ///< of the extent of the part that has it; such a one is closed

double volume_of(const Points& points) {
  double volume = 0.0;
  for (const auto& [a, b, c] : hull_triangles(points)) {
    const auto at = [&](int i) -> Eigen::Vector3d { return points[static_cast<std::size_t>(i)] - points[0]; };
    volume += at(a).dot(at(b).cross(at(c))) / 6.0;
  }
  return volume;
}

/// Evenly over the sphere (a Fibonacci lattice).
const Points& judging_directions() {
  static const Points all = [] {
    Points directions;
    for (std::size_t i = 0; i < directions_to_judge; ++i) {
      const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / directions_to_judge;
      const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(i);
      directions.emplace_back(std::sqrt(1.0 - z * z) * std::cos(turn),
                              std::sqrt(1.0 - z * z) * std::sin(turn), z);
    }
    return directions;
  }();
  return all;
}

/// Of the hull of the points that lie farthest in many directions: a little less than that of all.
double judged_volume(const Points& all) {
  const std::size_t stride = all.size() / most_points + 1;
  Points points;
  for (std::size_t i = 0; i < all.size(); i += stride) points.push_back(all[i]);
  Points farthest;
  for (const Eigen::Vector3d& direction : judging_directions())
    farthest.push_back(*std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      return a.dot(direction) < b.dot(direction);
    }));
  return volume_of(hull_corners(std::move(farthest)));
}

/// A plane across an axis.
struct Cut {
  int axis = 0;
  double at = 0.0;
};

/// Counter-clockwise hull of points of a plane across `axis` (Andrew's monotone chain).
Points hull_of_plane(Points points, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto key = [&](const Eigen::Vector3d& p) { return std::pair(p[u], p[v]); };
  std::sort(points.begin(), points.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Points hull;
  const auto add_half = [&](auto begin, auto end) {
    const std::size_t first = hull.size();
    for (auto p = begin; p != end; ++p) {
      const auto turns_right = [&] {
        const Eigen::Vector3d &a = hull[hull.size() - 2], &b = hull.back();
        return (b[u] - a[u]) * ((*p)[v] - a[v]) - (b[v] - a[v]) * ((*p)[u] - a[u]) <= 0.0;
      };
      while (hull.size() >= first + 2 && turns_right()) hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  add_half(points.begin(), points.end());
  add_half(points.rbegin(), points.rend());
  return hull;
}

/// Of a convex polygon.
double area_of(const Points& corners) {
  double area = 0.0;
  for (std::size_t i = 2; i < corners.size(); ++i)
    area += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]).norm() / 2.0;
  return area;
}

void add_polygon(const Points& corners, Points& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i)
    triangles.insert(triangles.end(), {corners[0], corners[i - 1], corners[i]});
}

/// Sets of numbers that belong together.
class Together {
 public:
  explicit Together(std::size_t count) : above_(count) {
    std::iota(above_.begin(), above_.end(), std::size_t{0});
  }
  std::size_t root(std::size_t i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { above_[root(a)] = root(b); }

 private:
  std::vector<std::size_t> above_;
};

/// Where a plane cuts triangles.
class Section {
 public:
  /// Where it crosses an edge, the same for both triangles that have it.
  Eigen::Vector3d crossing(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Cut& cut) const {
    const bool is_ordered = key(from) < key(to);
    const Eigen::Vector3d &a = is_ordered ? from : to, &b = is_ordered ? to : from;
    if (a[cut.axis] == cut.at) return a;
    if (b[cut.axis] == cut.at) return b;
    Eigen::Vector3d point = a + (cut.at - a[cut.axis]) / (b[cut.axis] - a[cut.axis]) * (b - a);
    point[cut.axis] = cut.at;
    return point;
  }
  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    if (a != b) segments_.emplace_back(number(a), number(b));
  }
  /// Hulls that cover what the mesh encloses of the plane: one for each curve, where all are closed; else
  /// one.
  std::vector<Points> caps(int axis) const {
    Together curves(points_.size());
    std::vector<int> ends(points_.size(), 0);
    for (const auto& [a, b] : segments_) curves.join(a, b), ++ends[a], ++ends[b];
    const bool are_closed = std::all_of(ends.begin(), ends.end(), [](int count) { return count % 2 == 0; });
    std::map<std::size_t, Points> of_curve;
    for (std::size_t i = 0; i < points_.size(); ++i)
      of_curve[are_closed ? curves.root(i) : 0].push_back(points_[i]);
    std::vector<Points> hulls;
    for (auto& [root, points] : of_curve) hulls.push_back(hull_of_plane(std::move(points), axis));
    return hulls;
  }

 private:
  static std::tuple<double, double, double> key(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
  std::size_t number(const Eigen::Vector3d& point) {
    const auto [at, is_new] = numbers_.try_emplace(key(point), points_.size());
    if (is_new) points_.push_back(point);
    return at->second;
  }
  std::map<std::tuple<double, double, double>, std::size_t> numbers_;
  Points points_;
  std::vector<std::pair<std::size_t, std::size_t>> segments_;
};

/// Below and above the plane, both closed by hulls of the section. A boundary that leads from the mesh over
/// to the cap of an earlier cut ends at that one's rim, which no curve goes on from: then there is one hull
/// of all.
/// @param waste becomes the area of hulls that lie in others: of a hole that they fill
std::array<Points, 2> cut_by(const Points& triangles, const Cut& cut, double& waste) {
  std::array<Points, 2> sides;
  Section section;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    std::array<Points, 2> polygons;
    Points crossings;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d &a = triangles[i + k], &b = triangles[i + (k + 1) % 3];
      const bool is_above = a[cut.axis] >= cut.at;
      polygons[is_above].push_back(a);
      if (is_above == (b[cut.axis] >= cut.at)) continue;
      crossings.push_back(section.crossing(a, b, cut));
      for (Points& polygon : polygons) polygon.push_back(crossings.back());
    }
    if (crossings.size() == 2) section.add(crossings[0], crossings[1]);
    for (std::size_t side = 0; side < 2; ++side) add_polygon(polygons[side], sides[side]);
  }
  waste = 0.0;
  std::vector<std::pair<Eigen::AlignedBox3d, double>> before;
  for (const Points& cap : section.caps(cut.axis)) {
    for (Points& side : sides) add_polygon(cap, side);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& corner : cap) box.extend(corner);
    const double area = area_of(cap);
    for (const auto& [other, other_area] : before)
      if (box.intersects(other)) waste += std::min(area, other_area);
    before.emplace_back(box, area);
  }
  return sides;
}

/// A part of the mesh, and how it is cut best.
struct Piece {
  Points triangles;  ///< once it is cut, corners of its hull
  bool may_be_cut = true;
  double volume = 0.0;  ///< of its hull, as it is judged
  double gain = 0.0;    ///< volume that the best cut saves
  Cut best{};
  int barren = 0;                      ///< how many cuts in turn, up to this piece, have saved nothing
  std::array<std::size_t, 2> sides{};  ///< where these are, once it is cut
  bool is_cut() const { return sides[0] != sides[1]; }
};

/// Every n-th triangle of many.
Points judged_part(const Points& triangles) {
  const std::size_t count = triangles.size() / 3, stride = count / most_judged + 1;
  Points part;
  for (std::size_t i = 0; i < count; i += stride)
    part.insert(part.end(), {triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]});
  return part;
}

/// What a cut seems to save of a volume, but for the error of judging it.
bool is_noise(double gain, double volume) { return gain <= 0.03 * volume; }

/// The cut that saves most. Where none saves anything, as of a ring, whose halves are as large as it is, the
/// one across the middle whose caps do not fill the hole: what later cuts save, these would hold.
void judge(Piece& piece) {
  const Points part = judged_part(piece.triangles);
  piece.volume = judged_volume(part);
  if (!piece.may_be_cut) return;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : part) box.extend(point);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::pair<double, double> fairest(-infinity, 0.0);  // less waste, larger smaller side
  Cut fair;
  piece.gain = -infinity;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 1; i <= cuts_of_an_axis; ++i) {
      const Cut cut{axis, box.min()[axis] + box.sizes()[axis] * i / (cuts_of_an_axis + 1)};
      double waste = 0.0;
      const auto sides = cut_by(part, cut, waste);
      if (sides[0].empty() || sides[1].empty()) continue;
      const double below = judged_volume(sides[0]), above = judged_volume(sides[1]);
      const double gain = piece.volume - below - above;
      if (gain > piece.gain) piece.gain = gain, piece.best = cut;
      const std::pair<double, double> fairness(-waste, std::min(below, above));
      if (is_noise(-gain, piece.volume) && fairness > fairest) fairest = fairness, fair = cut;
    }
  }
  piece.may_be_cut = std::isfinite(piece.gain);
  if (is_noise(piece.gain, piece.volume) && std::isfinite(fairest.first)) piece.best = fair;
}

/// How much a piece is worth being cut: by what that saves, and, as a ring has to be cut twice before it
/// saves anything, by its size.
double worth(const Piece& piece) {
  constexpr double of_size = 0.05;
  constexpr int most_barren = 3;
  if (!piece.may_be_cut || piece.is_cut() || piece.barren >= most_barren) return -1.0;
  return std::max(piece.gain, 0.0) + of_size * piece.volume;
}

/// Adds up the hulls of a piece: its own, or those of its sides where they are smaller by what is worth it.
double collect(std::vector<Piece>& pieces, std::size_t index, double least, std::vector<Points>& hulls) {
  Piece& piece = pieces[index];
  if (piece.is_cut()) {
    std::vector<Points> of_sides;
    const double first = collect(pieces, piece.sides[0], least, of_sides);
    const double sum = first + collect(pieces, piece.sides[1], least, of_sides);
    if (sum < piece.volume - least) {
      std::move(of_sides.begin(), of_sides.end(), std::back_inserter(hulls));
      return sum;
    }
  }
  hulls.push_back(hull_corners(std::move(piece.triangles)));
  return piece.volume;
}

/// The mesh with its small holes closed, by a fan about one of each one's corners; the number of the
/// connected part of each triangle, and which parts are closed.
struct Parts {
  Points triangles;
  std::vector<std::size_t> of_triangle;
  std::vector<bool> are_closed;
};

double extent_of(const Eigen::AlignedBox3d& box) { return box.isEmpty() ? 0.0 : box.sizes().maxCoeff(); }

Parts parts_of(const Points& triangles) {
  using Edge = std::pair<std::size_t, std::size_t>;
  std::map<std::tuple<double, double, double>, std::size_t> numbers;
  std::vector<std::size_t> corner;  // the number of each corner's vertex
  Points vertices;
  for (const Eigen::Vector3d& p : triangles) {
    corner.push_back(numbers.try_emplace({p.x(), p.y(), p.z()}, numbers.size()).first->second);
    if (corner.back() == vertices.size()) vertices.push_back(p);
  }
  Together parts(vertices.size()), holes(vertices.size());
  std::map<Edge, int> uses;
  const std::size_t count = triangles.size() / 3;
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<std::size_t, 3> c{corner[3 * i], corner[3 * i + 1], corner[3 * i + 2]};
    parts.join(c[1], c[0]);
    parts.join(c[2], c[0]);
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(c[k], c[(k + 1) % 3])];
  }
  std::map<std::size_t, std::size_t> part_of_root;
  std::vector<Eigen::AlignedBox3d> boxes;  // of the parts
  Parts found{triangles, {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto [at, is_new] = part_of_root.try_emplace(parts.root(corner[3 * i]), part_of_root.size());
    if (is_new) boxes.emplace_back();
    found.of_triangle.push_back(at->second);
    for (std::size_t k = 0; k < 3; ++k) boxes[at->second].extend(triangles[3 * i + k]);
  }
  found.are_closed.assign(boxes.size(), true);
  for (const auto& [edge, times] : uses)
    if (times % 2 != 0) holes.join(edge.first, edge.second);
  std::map<std::size_t, std::vector<Edge>> rims;
  for (const auto& [edge, times] : uses)
    if (times % 2 != 0) rims[holes.root(edge.first)].push_back(edge);
  for (const auto& [root, rim] : rims) {
    const std::size_t part = part_of_root.at(parts.root(root)), middle = rim.front().first;
    Eigen::AlignedBox3d box;
    for (const auto& [a, b] : rim) box.extend(vertices[a]), box.extend(vertices[b]);
    if (extent_of(box) > largest_hole * extent_of(boxes[part])) {
      found.are_closed[part] = false;
      continue;
    }
    for (const auto& [a, b] : rim) {
      if (a == middle || b == middle) continue;
      found.triangles.insert(found.triangles.end(), {vertices[middle], vertices[a], vertices[b]});
      found.of_triangle.push_back(part);
    }
  }
  return found;
}

/// The closed parts each for itself (all in one where they are more than hulls are wanted), and the rest.
std::vector<Piece> first_pieces(const Points& mesh, std::size_t most) {
  const Parts parts = parts_of(mesh);
  const Points& triangles = parts.triangles;
  const auto closed =
      static_cast<std::size_t>(std::count(parts.are_closed.begin(), parts.are_closed.end(), true));
  const bool are_apart = closed + (closed < parts.are_closed.size() ? 1 : 0) <= most;
  std::map<std::pair<bool, std::size_t>, Piece> pieces;
  for (std::size_t i = 0; i < parts.of_triangle.size(); ++i) {
    const std::size_t part = parts.of_triangle[i];
    const bool is_closed = parts.are_closed[part];
    Piece& piece = pieces[{is_closed, is_closed && are_apart ? part : 0}];
    piece.may_be_cut = is_closed;
    piece.triangles.insert(piece.triangles.end(),
                           {triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]});
  }
  std::vector<Piece> found;
  for (auto& [key, piece] : pieces) found.push_back(std::move(piece));
  return found;
}

}  // namespace

std::vector<std::vector<Eigen::Vector3d>> convex_pieces(const std::vector<Eigen::Vector3d>& triangles,
                                                        std::size_t most) {
  std::vector<Piece> pieces = first_pieces(triangles, most);
  if (pieces.size() > most) pieces = {{triangles, false}};  // of one hull, the closed ones and the rest
  const std::size_t roots = pieces.size();
  for (Piece& piece : pieces)
    if (roots < most) judge(piece);
  for (std::size_t hulls = roots; hulls < most; ++hulls) {
    const auto next = std::max_element(pieces.begin(), pieces.end(),
                                       [](const Piece& a, const Piece& b) { return worth(a) < worth(b); });
    if (worth(*next) <= 0.0) break;
    const auto index = static_cast<std::size_t>(next - pieces.begin());
    double waste = 0.0;
    auto sides = cut_by(next->triangles, next->best, waste);
    const int barren = is_noise(next->gain, next->volume) ? next->barren + 1 : 0;
    pieces[index].triangles =
        hull_corners(std::move(pieces[index].triangles));  // all that may still be asked for
    pieces[index].sides = {pieces.size(), pieces.size() + 1};
    for (Points& side : sides) {
      pieces.push_back({std::move(side)});
      pieces.back().barren = barren;
      judge(pieces.back());
    }
  }
  double volume = 0.0;
  for (std::size_t i = 0; i < roots; ++i) volume += pieces[i].volume;
  std::vector<Points> hulls;
  for (std::size_t i = 0; i < roots; ++i) collect(pieces, i, least_gain * volume, hulls);
  return hulls;
}

}  // namespace clearway
