#include "planning/path/shortcut.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "planning/path/path_pieces.hpp"

namespace clearway {
std::vector<Configuration> shortcut(const ConfigurationSpace& space, std::vector<Configuration> path,
                                    const Eigen::VectorXd& weight, std::uint64_t seed, int attempts) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int attempt = 0; attempt < attempts && path.size() > 2; ++attempt) {
    const std::vector<double> lengths = edge_lengths(path, weight);
    const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    double a = whole * uniform(random), b = whole * uniform(random);
    if (attempt == 0) a = 0.0, b = whole;  // the straight way first
    const PlaceOnPath from = place_at(lengths, std::min(a, b)), to = place_at(lengths, std::max(a, b));
    if (from.edge == to.edge) continue;
    const Configuration start = point_at(path, from), end = point_at(path, to);
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
