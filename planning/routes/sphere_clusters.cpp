#include "planning/routes/sphere_clusters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>

namespace clearway {
namespace {

constexpr std::size_t spheres_a_look = 1024;  // at the time

using Cell = std::array<std::int64_t, 4>;  // x, y, z, and a size

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t value : cell)
      hash = (hash ^ static_cast<std::uint64_t>(value)) * 0x9e3779b97f4a7c15U, hash ^= hash >> 29U;
    return static_cast<std::size_t>(hash);
  }
};

/// 2^size <= length < 2^(size + 1).
int size_of(double length) { return std::ilogb(std::max(length, 1e-300)); }

Cell cell_of(const Eigen::Vector3d& point, double edge, int size) {
  const Eigen::Array3d at = (point.array() / edge).floor();
  return {static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(at.y()),
          static_cast<std::int64_t>(at.z()), size};
}

struct Assignment {
  std::vector<std::size_t> cluster;  ///< of each sphere
  std::size_t count = 0;
};

/// By cells with an edge of `share` times the spheres' size; nothing when there are too many or it was
/// stopped.
std::optional<Assignment> assigned(const std::vector<Sphere>& spheres, double share, std::size_t most,
                                   const std::function<bool()>& is_stopped) {
  Assignment found;
  std::unordered_map<Cell, std::size_t, CellHash> clusters;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (i % spheres_a_look == 0 && is_stopped && is_stopped()) return std::nullopt;
    const int size = size_of(spheres[i].radius);
    const Cell cell = cell_of(spheres[i].center, share * std::ldexp(1.0, size), size);
    found.cluster.push_back(clusters.try_emplace(cell, clusters.size()).first->second);
    if (clusters.size() > most) return std::nullopt;
  }
  found.count = clusters.size();
  return found;
}

/// With cells as large as the least radius, sqrt(3) of which is less than the least sum of two radii.
Assignment assigned(const std::vector<Sphere>& spheres, std::size_t most,
                    const std::function<bool()>& is_stopped) {
  if (spheres.size() <= most) {
    Assignment each;
    for (; each.count < spheres.size(); ++each.count) each.cluster.push_back(each.count);
    return each;
  }
  for (const double share : {0.125, 0.25, 0.5}) {
    if (auto found = assigned(spheres, share, most, is_stopped)) return *std::move(found);
  }
  if (auto found = assigned(spheres, 1.0, spheres.size(), is_stopped)) return *std::move(found);
  return {};
}

}  // namespace

SphereClusters::SphereClusters(const std::vector<Sphere>& spheres, std::size_t most,
                               const std::function<bool()>& is_stopped) {
  const Assignment assignment = assigned(spheres, most, is_stopped);
  first_.assign(assignment.count + 1, 0);
  if (assignment.count == 0) return;
  for (const std::size_t cluster : assignment.cluster) ++first_[cluster + 1];
  for (std::size_t i = 0; i < assignment.count; ++i) first_[i + 1] += first_[i];
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  spheres_.resize(spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) spheres_[next[assignment.cluster[i]]++] = spheres[i];
  for (std::size_t i = 0; i < assignment.count; ++i) {
    const auto own = this->spheres(i);
    largest_.push_back(*std::max_element(
        own.begin(), own.end(), [](const Sphere& a, const Sphere& b) { return a.radius < b.radius; }));
    double reach = 0.0;
    for (const Sphere& sphere : own)
      reach = std::max(reach, (sphere.center - largest_[i].center).norm() + sphere.radius);
    reach_.push_back(reach);
  }
}

/// Clusters of each size lie in a grid of their own, so that small ones do not crowd a large one's cells.
void SphereClusters::visit_near_pairs(const std::function<void(std::size_t, std::size_t)>& visit,
                                      const std::function<bool()>& is_stopped) const {
  struct Grid {
    double edge = 0.0, reach = 0.0;
    std::unordered_map<Cell, std::vector<std::size_t>, CellHash> cells;
  };
  std::map<int, Grid> grids;  // by the size of reaches
  for (std::size_t i = 0; i < size(); ++i) {
    Grid& grid = grids[size_of(reach_[i])];
    grid.edge = std::ldexp(4.0, size_of(reach_[i]));  // two of them reach no farther
    grid.reach = std::max(grid.reach, reach_[i]);
    grid.cells[cell_of(largest_[i].center, grid.edge, 0)].push_back(i);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (is_stopped && is_stopped()) return;
    const int own = size_of(reach_[i]);
    for (const auto& [size, grid] : grids) {
      if (size > own) break;  // found from there
      const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_[i] + grid.reach);
      const Cell low = cell_of(largest_[i].center - reach, grid.edge, 0);
      const Cell high = cell_of(largest_[i].center + reach, grid.edge, 0);
      for (std::int64_t x = low[0]; x <= high[0]; ++x) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          for (std::int64_t z = low[2]; z <= high[2]; ++z) {
            const auto cell = grid.cells.find({x, y, z, 0});
            if (cell == grid.cells.end()) continue;
            for (const std::size_t j : cell->second) {
              if (j == i || (largest_[i].center - largest_[j].center).norm() > reach_[i] + reach_[j])
                continue;
              visit(i, j);
              if (size != own) visit(j, i);
            }
          }
        }
      }
    }
  }
}

}  // namespace clearway
