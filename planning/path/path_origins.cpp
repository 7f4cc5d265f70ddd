#include "planning/path/path_origins.hpp"

#include <algorithm>
#include <limits>

namespace clearway {
namespace {

/// Of a configuration to the straight edge from a to b.
double distance_to_edge(const Configuration& q, const Configuration& a, const Configuration& b) {
  const Eigen::VectorXd way = b - a;
  const double squared = way.squaredNorm();
  const double share = squared > 0.0 ? std::clamp(way.dot(q - a) / squared, 0.0, 1.0) : 0.0;
  return (q - a - share * way).norm();
}

}  // namespace

std::vector<WaypointOrigin> origins_after(const std::vector<Configuration>& before,
                                          const std::vector<WaypointOrigin>& origins,
                                          const std::vector<Configuration>& after) {
  constexpr double rounding = 1e-9;
  if (origins.size() != before.size() || after.empty()) return {};
  std::vector<WaypointOrigin> result{{}};
  std::size_t from = 1;  // the edge of `before` that leads there
  for (std::size_t i = 1; i < after.size(); ++i) {
    result.push_back({PathPhase::shortened, {}, 0});
    for (std::size_t k = from; k < before.size(); ++k) {
      const bool is_part = distance_to_edge(after[i - 1], before[k - 1], before[k]) <= rounding &&
                           distance_to_edge(after[i], before[k - 1], before[k]) <= rounding;
      if (!is_part) continue;
      result.back() = origins[k];
      from = k;
      break;
    }
  }
  return result;
}

std::vector<std::size_t> waypoints_ahead(const std::vector<Configuration>& path,
                                         const std::vector<Configuration>& along) {
  std::vector<std::size_t> ahead(along.size(), 0);
  if (path.size() < 2) return ahead;
  // Not so far ahead that a path which comes by again is taken for its later part.
  const std::size_t window = 8 + 4 * path.size() / std::max<std::size_t>(along.size(), 1);
  std::size_t from = 1;
  for (std::size_t i = 0; i < along.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = from;
    for (std::size_t k = from; k < path.size() && k <= from + window; ++k) {
      const double distance = distance_to_edge(along[i], path[k - 1], path[k]);
      if (!(distance < least - 1e-9)) continue;
      least = distance;
      best = k;
    }
    ahead[i] = from = best;
  }
  return ahead;
}

}  // namespace clearway
