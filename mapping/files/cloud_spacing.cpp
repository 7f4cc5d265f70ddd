#include "mapping/files/cloud_spacing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

namespace clearway {
namespace {

using Indices = std::vector<std::size_t>;
using Points = std::vector<Eigen::Vector3f>;

constexpr std::size_t of_grid = 4;  ///< neighbours a step away, over a surface
constexpr std::size_t fewest_points = 30;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The number of the cell of this edge that a point is in. Neighbours along z follow one another.
class CellNumber {
 public:
  CellNumber(const Eigen::Vector3f& point, double edge) {
    constexpr double farthest = (1 << 20) - 2;
    for (int i = 0; i < 3; ++i)
      cell_[static_cast<std::size_t>(i)] = static_cast<std::uint64_t>(
          (1 << 20) + std::clamp(std::floor(static_cast<double>(point[i]) / edge), -farthest, farthest));
  }
  std::uint64_t operator()(int x = 0, int y = 0, int z = 0) const {
    const auto beside = [](std::uint64_t cell, int step) { return cell + static_cast<std::uint64_t>(step); };
    return beside(cell_[0], x) << 42 | beside(cell_[1], y) << 21 | beside(cell_[2], z);
  }

 private:
  std::array<std::uint64_t, 3> cell_;
};

/// Some of a cloud's points, by cells.
class PointCells {
 public:
  PointCells(const Points& points, const Indices& held, double edge) : points_(points), edge_(edge) {
    std::vector<std::pair<std::uint64_t, std::size_t>> rows;
    rows.reserve(held.size());
    for (const std::size_t i : held) rows.push_back({CellNumber(points[i], edge)(), i});
    std::sort(rows.begin(), rows.end());
    held_.reserve(rows.size());
    std::vector<Column> columns;
    for (const auto& [cell, i] : rows) {
      const auto at = static_cast<std::uint32_t>(held_.size());
      if (columns.empty() || columns.back().number != column_of(cell))
        columns.push_back({column_of(cell), at, at});
      held_.push_back({cell, static_cast<std::uint32_t>(i), points[i]});
      ++columns.back().end;
    }
    columns_.resize(std::bit_ceil(columns.size() + columns.size() / 4 + 1));
    for (const Column& column : columns) columns_[slot_of(column.number)] = column;
  }

  double edge() const { return edge_; }

  /// Visits the held points other than `i` that are within the cells' edge of it, with their distance, until
  /// `visit` returns false.
  template <typename Visit>
  void visit_near(std::size_t i, const Visit& visit) const {
    const CellNumber cell(points_[i], edge_);
    for (const int k : {4, 1, 3, 5, 7, 0, 2, 6, 8}) {  // its own row of cells first
      const std::uint64_t first = cell(k % 3 - 1, k / 3 - 1, -1), last = cell(k % 3 - 1, k / 3 - 1, 1);
      const Column& column = columns_[slot_of(column_of(first))];
      const auto end = held_.begin() + static_cast<std::ptrdiff_t>(column.end);
      auto at = std::lower_bound(held_.begin() + static_cast<std::ptrdiff_t>(column.begin), end, first,
                                 [](const Held& held, std::uint64_t number) { return held.cell < number; });
      for (; at != end && at->cell <= last; ++at) {
        const Eigen::Vector3f way = points_[i] - at->point;
        const double apart = way.cast<double>().norm();
        if (at->index != i && apart <= edge_ && !visit(at->index, apart)) return;
      }
    }
  }

  /// Visits the held points in the order of their cells, in which looking at what is near them is fastest.
  template <typename Visit>
  void visit_held(const Visit& visit) const {
    for (const Held& held : held_) visit(held.index);
  }

  /// The distance of the `rank`-th nearest other point; infinite where fewer are within the edge.
  double nearest(std::size_t i, std::size_t rank) const {
    std::vector<double> near;
    visit_near(i, [&](std::size_t, double apart) {
      near.push_back(apart);
      return true;
    });
    if (near.size() < rank) return infinite;
    const auto at = near.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(near.begin(), at, near.end());
    return *at;
  }

  /// Whether at least `count` others are within the edge.
  bool has_near(std::size_t i, std::size_t count) const {
    visit_near(i, [&](std::size_t, double) { return --count > 0; });
    return count == 0;
  }

  /// Those of these held points that have fewer near them.
  Indices without_near(const Indices& held, std::size_t count) const {
    std::vector<bool> has(points_.size());
    visit_held([&](std::size_t i) { has[i] = has_near(i, count); });
    Indices found;
    std::copy_if(held.begin(), held.end(), std::back_inserter(found), [&](std::size_t i) { return !has[i]; });
    return found;
  }

 private:
  struct Held {
    std::uint64_t cell;
    std::uint32_t index;
    Eigen::Vector3f point;
  };
  /// The held points of the cells above one another; without any where `begin` is `end`.
  struct Column {
    std::uint64_t number = 0;
    std::uint32_t begin = 0, end = 0;
  };
  static std::uint64_t column_of(std::uint64_t cell) { return cell >> 21; }
  /// Where a column stands, or would.
  std::size_t slot_of(std::uint64_t column) const {
    const std::size_t last = columns_.size() - 1;
    std::size_t slot = (column * 0x9e3779b97f4a7c15U) >> 20U & last;
    while (columns_[slot].begin != columns_[slot].end && columns_[slot].number != column)
      slot = (slot + 1) & last;
    return slot;
  }

  const Points& points_;
  double edge_;
  std::vector<Held> held_;       ///< in the order of cells
  std::vector<Column> columns_;  ///< a hash table with empty places
};

/// Of each sample the distance of its `rank`-th nearest other point, in rising order. Infinite where fewer
/// are within the cells' edge.
std::vector<double> nearest(const PointCells& cells, const Indices& samples, std::size_t rank) {
  std::vector<double> found;
  for (const std::size_t i : samples) found.push_back(cells.nearest(i, rank));
  std::sort(found.begin(), found.end());
  return found;
}

double at_part(const std::vector<double>& sorted, double part) {
  return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

/// Whether the samples lie on a grid of this step.
bool is_lattice(const Points& points, const Indices& samples, double step) {
  return std::all_of(samples.begin(), samples.end(), [&](std::size_t i) {
    const Eigen::Array3d steps = (points[i] - points[samples.front()]).cast<double>().array() / step;
    return (steps - steps.round()).abs().maxCoeff() < 1e-2;
  });
}

/// One point of each cell of this edge, so that points that lie on one another count once.
Indices apart_by_cells(const Points& points, double edge) {
  std::vector<std::pair<std::uint64_t, std::size_t>> rows;
  rows.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) rows.push_back({CellNumber(points[i], edge)(), i});
  std::sort(rows.begin(), rows.end());
  Indices kept;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (i == 0 || rows[i].first != rows[i - 1].first) kept.push_back(rows[i].second);
  std::sort(kept.begin(), kept.end());
  return kept;
}

Indices spread(const Indices& indices, std::size_t most) {
  Indices samples;
  const std::size_t count = std::min(indices.size(), most);
  for (std::size_t i = 0; i < count; ++i) samples.push_back(indices[i * indices.size() / count]);
  return samples;
}

constexpr double least_apart = 0.5;  ///< the second nearest of points evenly apart, of the fourth nearest
constexpr int doublings = 6;         ///< of the reach within which neighbours are looked for

/// The median distance of the fourth nearest, where the points are a surface's that was thinned.
std::optional<double> even_spacing(const Points& points, const Indices& held, double fine) {
  constexpr std::size_t most_samples = 400;
  // Measured of grids of 3 to 8 cm over planes, boxes and spheres, with noise and without: at most 1.55, at
  // least 0.54. Of points strewn over a plane or in space: at least 1.86, at most 0.46.
  constexpr double widest_spread = 1.7;
  if (held.size() < fewest_points) return std::nullopt;
  const Indices samples = spread(held, most_samples);
  std::optional<PointCells> cells;
  const auto nearest_of = [&](double reach, std::size_t rank) {
    if (!cells || cells->edge() != reach) cells.emplace(points, held, reach);
    return nearest(*cells, samples, rank);
  };
  const bool is_fine = at_part(nearest_of(1.05 * fine, 1), 0.5) <= 1.05 * fine;
  if (is_fine && is_lattice(points, samples, fine)) return std::nullopt;
  double reach = 1.05 * fine, apart = at_part(nearest_of(reach, of_grid), 0.5);
  if (apart <= reach) return std::nullopt;
  for (int i = 0; i < doublings && !(apart <= reach); ++i) {
    reach *= 2.0;
    apart = at_part(nearest_of(reach, of_grid), 0.5);
  }
  if (!(apart <= reach)) return std::nullopt;
  const std::vector<double> steps = nearest_of(2.0 * apart, of_grid);
  const bool is_even = at_part(steps, 0.95) <= widest_spread * at_part(steps, 0.05) ||
                       at_part(nearest_of(2.0 * apart, 2), 0.05) >= least_apart * apart;
  if (!is_even) return std::nullopt;
  return apart;
}

/// Of each point the distance of its fourth nearest among `held`; infinite for others and for lone ones.
std::vector<double> grid_steps(const Points& points, const Indices& held, double fine) {
  std::vector<double> steps(points.size(), infinite);
  Indices open = held;
  double reach = 1.05 * fine;
  for (int k = 0; k <= doublings && !open.empty(); ++k, reach *= 2.0) {
    const PointCells cells(points, held, reach);
    cells.visit_held([&](std::size_t i) {
      if (steps[i] == infinite) steps[i] = cells.nearest(i, of_grid);
    });
    std::erase_if(open, [&](std::size_t i) { return steps[i] < infinite; });
  }
  return steps;
}

/// Points in groups of neighbours that are as far apart.
class AlikeGroups {
 public:
  AlikeGroups(const Points& points, const Indices& held, double fine)
      : root_(points.size()), steps_(grid_steps(points, held, fine)) {
    std::iota(root_.begin(), root_.end(), 0);
    double reach = 1.05 * fine;
    for (int k = 0; k <= doublings; ++k, reach *= 2.0)
      join_within(points, held, reach, k == 0 ? 0.0 : reach / 2);
  }
  std::size_t of(std::size_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }

 private:
  static constexpr double joined = 1.5, alike = 1.5;
  /// Joins those whose steps are within (above, reach] to their neighbours.
  void join_within(const Points& points, const Indices& held, double reach, double above) {
    Indices near;
    std::copy_if(held.begin(), held.end(), std::back_inserter(near),
                 [&](std::size_t i) { return steps_[i] <= alike * reach; });
    const PointCells cells(points, near, joined * reach);
    for (const std::size_t i : near) {
      if (!(steps_[i] > above && steps_[i] <= reach)) continue;
      cells.visit_near(i, [&](std::size_t other, double apart) {
        const auto [less, more] = std::minmax(steps_[i], steps_[other]);
        if (more <= alike * less && apart <= joined * more) root_[of(i)] = of(other);
        return true;
      });
    }
  }

  Indices root_;
  std::vector<double> steps_;
};

/// Cells of the same points for distances of each size, made when asked for.
class CellsOfReach {
 public:
  CellsOfReach(const Points& points, const Indices& held, double least)
      : points_(points), held_(held), least_(least) {}
  /// With an edge of at least `reach`, at most twice that.
  const PointCells& of(double reach) {
    double edge = least_;
    while (edge < reach) edge *= 2.0;
    return cells_.try_emplace(edge, points_, held_, edge).first->second;
  }

 private:
  const Points& points_;
  const Indices& held_;
  double least_;
  std::map<double, PointCells> cells_;
};

/// Whether the points of a group spread along more than a line, and hardly any others are between them: of
/// points strewn at random some are as far apart as their neighbours.
bool is_surface_of_its_own(const Points& points, const Indices& group, CellsOfReach& all, double apart,
                           AlikeGroups& groups) {
  constexpr double of_line = 0.55, of_mixed = 0.3;
  const Indices samples = spread(group, 400);
  if (!(at_part(nearest(PointCells(points, group, apart), samples, 2), 0.5) > of_line * apart)) return false;
  const PointCells& cells = all.of(apart);
  std::size_t mixed = 0;
  for (const std::size_t i : samples) {
    bool is_mixed = false;
    cells.visit_near(i, [&](std::size_t other, double distance) {
      is_mixed = distance <= apart && groups.of(other) != groups.of(i);
      return !is_mixed;
    });
    mixed += is_mixed;
  }
  return static_cast<double>(mixed) <= of_mixed * static_cast<double>(samples.size());
}

}  // namespace

std::optional<double> thinned_spacing(const Points& points, double fine) {
  return even_spacing(points, apart_by_cells(points, 0.25 * fine), fine);
}

std::vector<ThinnedPart> thinned_parts(const Points& points, double fine) {
  constexpr std::size_t beside_in_a_row = 2;
  const Indices distinct = apart_by_cells(points, 0.25 * fine);
  const Indices sparse = PointCells(points, distinct, 1.05 * fine).without_near(distinct, beside_in_a_row);
  CellsOfReach reaches(points, distinct, 1.05 * fine);
  AlikeGroups groups(points, sparse, fine);
  std::map<std::size_t, Indices> members;
  for (const std::size_t i : sparse) members[groups.of(i)].push_back(i);
  std::vector<ThinnedPart> parts;
  for (auto& [first, group] : members)
    if (const auto apart = even_spacing(points, group, fine);
        apart && is_surface_of_its_own(points, group, reaches, *apart, groups))
      parts.push_back({*apart, std::move(group)});
  return parts;
}

std::optional<ThinnedPart> strewn_part(const Points& points, double fine) {
  constexpr double from = 0.7, to = 3.0, least_share = 0.05;
  const Indices distinct = apart_by_cells(points, 0.25 * fine);
  const PointCells near(points, distinct, from * fine);
  const Indices few = spread(distinct, 4000);
  const auto strewn =
      std::count_if(few.begin(), few.end(), [&](std::size_t i) { return !near.has_near(i, of_grid); });
  if (static_cast<double>(strewn) < 0.8 * least_share * static_cast<double>(few.size())) return std::nullopt;
  Indices open = near.without_near(distinct, of_grid);
  const PointCells wide(points, distinct, to * fine);
  std::erase_if(open, [&](std::size_t i) { return !wide.has_near(i, of_grid); });
  if (open.size() < fewest_points ||
      static_cast<double>(open.size()) < least_share * static_cast<double>(distinct.size()))
    return std::nullopt;
  const Indices samples = spread(open, 400);
  const double apart = at_part(nearest(wide, samples, of_grid), 0.5);
  if (at_part(nearest(wide, samples, 2), 0.05) >= least_apart * apart) return std::nullopt;
  return ThinnedPart{apart, std::move(open)};
}

}  // namespace clearway
