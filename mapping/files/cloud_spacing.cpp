#include "mapping/files/cloud_spacing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace clearway {
namespace {

/// The points near some of them, by cells: of a cloud of any size only these are kept.
class PointCells {
 public:
  PointCells(const std::vector<Eigen::Vector3f>& points, const std::vector<std::size_t>& samples, double edge)
      : points_(points), edge_(edge) {
    for (const std::size_t i : samples)
      for (int k = 0; k < 27; ++k) cells_.try_emplace(beside(cell_of(points[i]), k));
    for (std::size_t i = 0; i < points.size(); ++i)
      if (const auto found = cells_.find(cell_of(points[i])); found != cells_.end())
        found->second.push_back(i);
  }

  /// Distances of other points from a sample, each at most `edge`.
  template <typename Visit>
  void visit_near(std::size_t sample, const Visit& visit) const {
    for (int k = 0; k < 27; ++k)
      for (const std::size_t i : cells_.at(beside(cell_of(points_[sample]), k))) {
        const double apart = (points_[i] - points_[sample]).cast<double>().norm();
        if (i != sample && apart <= edge_) visit(apart);
      }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct HashOfCell {
    std::size_t operator()(const Cell& cell) const {
      const auto part = [&](std::size_t i, std::uint64_t factor) {
        return static_cast<std::uint64_t>(cell[i]) * factor;
      };
      return part(0, 73856093) ^ part(1, 19349663) ^ part(2, 83492791);
    }
  };
  static Cell beside(const Cell& cell, int k) {
    return {cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1};
  }
  Cell cell_of(const Eigen::Vector3f& point) const {
    constexpr double farthest = 1e15;  // the map's reach is less
    Cell cell;
    for (int i = 0; i < 3; ++i)
      cell[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(
          std::clamp(std::floor(static_cast<double>(point[i]) / edge_), -farthest, farthest));
    return cell;
  }

  const std::vector<Eigen::Vector3f>& points_;
  double edge_;
  std::unordered_map<Cell, std::vector<std::size_t>, HashOfCell> cells_;
};

/// Of each sample the distance of its `rank`-th nearest other point, in rising order. Infinite where fewer
/// are within `reach`.
std::vector<double> nearest(const std::vector<Eigen::Vector3f>& points,
                            const std::vector<std::size_t>& samples, double reach, std::size_t rank) {
  const PointCells cells(points, samples, reach);
  std::vector<double> found;
  for (const std::size_t i : samples) {
    std::vector<double> near;
    cells.visit_near(i, [&](double apart) { near.push_back(apart); });
    const auto at = near.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    if (near.size() >= rank) std::nth_element(near.begin(), at, near.end());
    found.push_back(near.size() >= rank ? *at : std::numeric_limits<double>::infinity());
  }
  std::sort(found.begin(), found.end());
  return found;
}

double at_part(const std::vector<double>& sorted, double part) {
  return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

/// Whether the samples lie on a grid of this step.
bool is_lattice(const std::vector<Eigen::Vector3f>& points, const std::vector<std::size_t>& samples,
                double step) {
  return std::all_of(samples.begin(), samples.end(), [&](std::size_t i) {
    const Eigen::Array3d steps = (points[i] - points[samples.front()]).cast<double>().array() / step;
    return (steps - steps.round()).abs().maxCoeff() < 1e-2;
  });
}

}  // namespace

std::optional<double> thinned_spacing(const std::vector<Eigen::Vector3f>& points, double fine) {
  constexpr std::size_t most_samples = 400, fewest_points = 30;
  constexpr int doublings = 6;
  constexpr std::size_t of_grid = 4;  ///< neighbours a step away, over a surface
  // Measured of grids of 3 to 8 cm over planes, boxes and spheres, with noise and without: at most 1.55, at
  // least 0.54. Of points strewn over a plane or in space: at least 1.86, at most 0.46.
  constexpr double widest_spread = 1.7, least_apart = 0.5;
  if (points.size() < fewest_points) return std::nullopt;
  std::vector<std::size_t> samples;
  const std::size_t count = std::min(points.size(), most_samples);
  for (std::size_t i = 0; i < count; ++i) samples.push_back(i * points.size() / count);
  const bool is_fine = at_part(nearest(points, samples, 1.05 * fine, 1), 0.5) <= 1.05 * fine;
  if (is_fine && is_lattice(points, samples, fine)) return std::nullopt;
  double reach = 1.05 * fine, apart = at_part(nearest(points, samples, reach, of_grid), 0.5);
  if (apart <= reach) return std::nullopt;
  for (int i = 0; i < doublings && !(apart <= reach); ++i) {
    reach *= 2.0;
    apart = at_part(nearest(points, samples, reach, of_grid), 0.5);
  }
  if (!(apart <= reach)) return std::nullopt;
  const std::vector<double> steps = nearest(points, samples, 2.0 * apart, of_grid);
  const bool is_even = at_part(steps, 0.95) <= widest_spread * at_part(steps, 0.05) ||
                       at_part(nearest(points, samples, 2.0 * apart, 2), 0.05) >= least_apart * apart;
  if (!is_even) return std::nullopt;
  return apart;
}

}  // namespace clearway
