#include "planning/shortcut.hpp"

#include <algorithm>
#include <numeric>
#include <random>

namespace clearway {
namespace {

/// A point on a path: at `share` of the edge that starts at waypoint `edge`.
struct Place {
  std::size_t edge = 0;
  double share = 0.0;
};

std::vector<double> edge_lengths(const std::vector<Configuration>& path, const Eigen::VectorXd& weight) {
  std::vector<double> lengths;
  for (std::size_t i = 1; i < path.size(); ++i)
    lengths.push_back(weight.cwiseProduct(path[i] - path[i - 1]).norm());
  return lengths;
}

Place place_at(const std::vector<double>& lengths, double along) {
  for (std::size_t i = 0; i + 1 < lengths.size(); ++i) {
    if (along <= lengths[i]) return {i, lengths[i] > 0.0 ? along / lengths[i] : 0.0};
    along -= lengths[i];
  }
  return {lengths.size() - 1, lengths.back() > 0.0 ? std::min(1.0, along / lengths.back()) : 1.0};
}

Configuration point(const std::vector<Configuration>& path, const Place& place) {
  if (place.share >= 1.0) return path[place.edge + 1];
  return path[place.edge] + place.share * (path[place.edge + 1] - path[place.edge]);
}

}  // namespace

std::vector<Configuration> shortcut(const ConfigurationSpace& space, std::vector<Configuration> path,
                                    const Eigen::VectorXd& weight, std::uint64_t seed, int attempts) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int attempt = 0; attempt < attempts && path.size() > 2; ++attempt) {
    const std::vector<double> lengths = edge_lengths(path, weight);
    const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    double a = whole * uniform(random), b = whole * uniform(random);
    if (attempt == 0) a = 0.0, b = whole;  // the straight way first
    const Place from = place_at(lengths, std::min(a, b)), to = place_at(lengths, std::max(a, b));
    if (from.edge == to.edge) continue;
    const Configuration start = point(path, from), end = point(path, to);
    // The pieces left of the two cut edges are certified anew: a piece of a free edge need not prove as
    // easily.
    if (!space.is_edge_free(start, end) || !space.is_edge_free(path[from.edge], start) ||
        !space.is_edge_free(end, path[to.edge + 1])) {
      continue;
    }
    std::vector<Configuration> shorter(path.begin(),
                                       path.begin() + static_cast<std::ptrdiff_t>(from.edge) + 1);
    if (start != shorter.back()) shorter.push_back(start);
    if (end != path[to.edge + 1]) shorter.push_back(end);
    shorter.insert(shorter.end(), path.begin() + static_cast<std::ptrdiff_t>(to.edge) + 1, path.end());
    path = std::move(shorter);
  }
  return path;
}

}  // namespace clearway
