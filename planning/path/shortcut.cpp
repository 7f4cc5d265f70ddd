#include "planning/path/shortcut.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "mapping/system/random_unit.hpp"
#include "planning/path/path_pieces.hpp"

namespace clearway {
namespace {

/// Shortens a path whose edges are certified, so that they stay so: a part of a certified edge is certified.
class Shortener {
 public:
  Shortener(const ConfigurationSpace& space, std::vector<Configuration> path, const Eigen::VectorXd& weight,
            int attempts)
      : space_(space), weight_(weight), path_(std::move(path)), left_(attempts) {}

  /// From each waypoint on the farthest jump that is free; of many waypoints the last, then half as far, ...
  void jump() {
    for (std::size_t from = 0; from + 2 < path_.size(); ++from) {
      constexpr std::size_t few = 8;
      for (std::size_t to = path_.size() - 1; to > from + 1;
           to -= to - from > few ? (to - from) / 2 : std::size_t{1}) {
        if (!space_.is_edge_free(path_[from], path_[to])) continue;
        path_.erase(at(from + 1), at(to));
        break;
      }
    }
  }

  /// Two points of the path joined, over and over; in turn any two, and two about a waypoint. Ends when so
  /// many tries in a row, more for longer paths, gained nothing worth while.
  void cut(std::mt19937_64& random) {
    constexpr double worth_while = 0.002;
    const int patience = 8 + 2 * static_cast<int>(path_.size());
    for (int idle = 0; idle < patience && left_ > 0 && path_.size() > 2;) {
      const std::vector<double> lengths = edge_lengths(path_, weight_);
      const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
      const auto [from, to] = left_ % 2 == 0 ? any_two(lengths, whole, random) : about_a_waypoint(random);
      const double gained = join(from, to);
      idle = gained > worth_while * whole ? 0 : idle + 1;
    }
  }

  std::vector<Configuration> path() && { return std::move(path_); }

 private:
  using Places = std::pair<PlaceOnPath, PlaceOnPath>;

  std::vector<Configuration>::iterator at(std::size_t index) {
    return path_.begin() + static_cast<std::ptrdiff_t>(index);
  }

  static Places any_two(const std::vector<double>& lengths, double whole, std::mt19937_64& random) {
    double a = whole * random_unit(random), b = whole * random_unit(random);
    if (a > b) std::swap(a, b);
    return {place_at(lengths, a), place_at(lengths, b)};
  }

  Places about_a_waypoint(std::mt19937_64& random) {
    const auto inner = static_cast<double>(path_.size() - 2);
    const std::size_t waypoint =
        1 + std::min(static_cast<std::size_t>(inner * random_unit(random)), path_.size() - 3);
    return {{waypoint - 1, random_unit(random)}, {waypoint, random_unit(random)}};
  }

  /// Joins two places of different edges; how much shorter that made the path.
  double join(const PlaceOnPath& from, const PlaceOnPath& to) {
    --left_;
    if (from.edge == to.edge) return 0.0;
    const Configuration start = point_at(path_, from), end = point_at(path_, to);
    const auto length = [&](const Configuration& a, const Configuration& b) {
      return weight_.cwiseProduct(b - a).norm();
    };
    double gained = -length(start, end) + length(start, path_[from.edge + 1]) + length(path_[to.edge], end);
    for (std::size_t i = from.edge + 1; i < to.edge; ++i) gained += length(path_[i], path_[i + 1]);
    if (gained <= 0.0 || !space_.is_edge_free(start, end)) return 0.0;
    std::vector<Configuration> shorter(path_.begin(), at(from.edge + 1));
    if (start != shorter.back()) shorter.push_back(start);
    if (end != path_[to.edge + 1]) shorter.push_back(end);
    shorter.insert(shorter.end(), at(to.edge + 1), path_.end());
    path_ = std::move(shorter);
    return gained;
  }

  const ConfigurationSpace& space_;
  const Eigen::VectorXd& weight_;
  std::vector<Configuration> path_;
  int left_;  ///< tries to cut
};

}  // namespace

std::vector<Configuration> shortcut(const ConfigurationSpace& space, std::vector<Configuration> path,
                                    const Eigen::VectorXd& weight, std::uint64_t seed, int attempts) {
  std::mt19937_64 random(seed);
  Shortener shortener(space, std::move(path), weight, attempts);
  if (attempts > 0) {
    shortener.jump();
    shortener.cut(random);
    shortener.jump();
  }
  return std::move(shortener).path();
}

}  // namespace clearway
