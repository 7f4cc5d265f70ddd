#include "planning/path/straightened_path.hpp"

#include <algorithm>

namespace clearway {
namespace {

using Waypoints = std::vector<Configuration>;

/// Whether the edge between them has a length that is not rounded to 0.
bool is_apart(const Configuration& a, const Configuration& b) { return (a - b).squaredNorm() > 0.0; }

class Straightener {
 public:
  Straightener(const ConfigurationSpace& space, const Waypoints& path, double tolerance)
      : space_(space), path_(path), tolerance_(tolerance) {}

  Waypoints run() const {
    Waypoints kept{path_.front()};
    for (std::size_t i = 0; i + 1 < path_.size();) {
      i = farthest_from(i);
      kept.push_back(path_[i]);
    }
    return kept;
  }

 private:
  /// A waypoint that can follow waypoint i: by doubled steps while they are certified, then by halved ones.
  std::size_t farthest_from(std::size_t i) const {
    const std::size_t last = path_.size() - 1;
    std::size_t good = i + 1, bad = last + 1;
    for (std::size_t step = 2; good < last && good + 1 < bad; step *= 2) {
      const std::size_t next = std::min(i + step, last);
      (can_skip(i, next) ? good : bad) = next;
      if (bad == next) break;
    }
    while (good + 1 < bad && bad <= last) {
      const std::size_t middle = good + (bad - good) / 2;
      (can_skip(i, middle) ? good : bad) = middle;
    }
    return good;
  }

  bool can_skip(std::size_t from, std::size_t to) const {
    for (std::size_t i = from + 1; i < to; ++i) {
      const Configuration there = nearest_on(path_[from], path_[to], path_[i]);
      if ((path_[i] - there).cwiseAbs().maxCoeff() > tolerance_) return false;
    }
    return is_apart(path_[from], path_[to]) && space_.is_edge_free(path_[from], path_[to]);
  }

  const ConfigurationSpace& space_;
  const Waypoints& path_;
  double tolerance_;
};

}  // namespace

Configuration nearest_on(const Configuration& from, const Configuration& to, const Configuration& q) {
  const Eigen::VectorXd step = to - from;
  const double length = step.squaredNorm();
  return length > 0.0 ? (from + std::clamp(step.dot(q - from) / length, 0.0, 1.0) * step).eval() : from;
}

std::vector<Configuration> without_doubles(const std::vector<Configuration>& path) {
  Waypoints kept{path.front()};
  for (const Configuration& q : path)
    if (is_apart(q, kept.back())) kept.push_back(q);
  return kept;
}

std::vector<Configuration> straightened(const ConfigurationSpace& space,
                                        const std::vector<Configuration>& path, double tolerance) {
  return Straightener(space, path, tolerance).run();
}

}  // namespace clearway
