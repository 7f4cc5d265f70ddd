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
            int attempts, const std::function<bool()>& out_of_time)
      : space_(space), weight_(weight), path_(std::move(path)), left_(attempts), out_of_time_(out_of_time) {}

  /// From each waypoint on the farthest jump that is free; of many waypoints the last, then half as far, ...
  void jump() {
    is_quick_ = false;
    for (std::size_t from = 0; from + 2 < path_.size(); ++from) {
      constexpr std::size_t few = 8;
      for (std::size_t to = path_.size() - 1; to > from + 1 && !out_of_time_();
           to -= to - from > few ? (to - from) / 2 : std::size_t{1}) {
        if (!is_free(path_[from], path_[to])) continue;
        path_.erase(at(from + 1), at(to));
        break;
      }
    }
  }

  /// Any two points of the path joined, over and over, until some tries in a row gained nothing worth while.
  void cut(std::mt19937_64& random) {
    is_quick_ = true;
    constexpr int patience = 5;
    for (int idle = 0; idle < patience && may_try(); ++idle) {
      const std::vector<double> lengths = edge_lengths(path_, weight_);
      const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
      const auto [from, to] = any_two(lengths, whole, random);
      --left_;
      if (join(from, to, worth_while * whole)) idle = -1;
    }
  }

  /// Each waypoint cut off as far as that is free, then the new ones, a few times over.
  void cut_corners() {
    is_quick_ = true;
    constexpr int rounds = 3;
    bool is_shorter = true;
    for (int round = 0; round < rounds && is_shorter; ++round) {
      const std::vector<double> lengths = edge_lengths(path_, weight_);
      const double worth = worth_while * std::accumulate(lengths.begin(), lengths.end(), 0.0);
      is_shorter = false;
      for (std::size_t i = 1; i + 1 < path_.size(); ++i) {
        const std::size_t before = path_.size();
        if (!cut_corner(i, worth)) continue;
        is_shorter = true;
        if (path_.size() >= before) ++i;  // two waypoints in place of one: they have their turn next time
      }
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

  /// The same length of both edges about a waypoint, that of the shorter one or a part of it.
  bool cut_corner(std::size_t waypoint, double worth) {
    const double before = length(path_[waypoint - 1], path_[waypoint]);
    const double after = length(path_[waypoint], path_[waypoint + 1]);
    const double shorter = std::min(before, after);
    double share = 1.0;
    for (int halvings = 0; halvings < 4 && may_try(); ++halvings, share *= 0.5) {
      const PlaceOnPath from{waypoint - 1, before > 0.0 ? 1.0 - share * shorter / before : 0.0};
      const PlaceOnPath to{waypoint, after > 0.0 ? share * shorter / after : 1.0};
      if (gain(from, to) < worth) return false;  // and less from a smaller part
      --left_;
      if (join(from, to, worth)) return true;
    }
    return false;
  }

  /// What was refused once is not asked again, as long as looking that up takes less than asking. Cuts, of
  /// which there are many to choose from, are asked of spheres alone: shapes take several times as long.
  bool is_free(const Configuration& from, const Configuration& to) {
    constexpr std::size_t most_remembered = 1000;
    const bool is_known = std::any_of(refused_.begin(), refused_.end(),
                                      [&](const Edge& edge) { return edge.from == from && edge.to == to; });
    if (is_known) return false;
    const bool free = is_quick_ ? space_.is_edge_quickly_free(from, to) : space_.is_edge_free(from, to);
    if (!free && refused_.size() < most_remembered) refused_.push_back({from, to});
    return free;
  }

  bool may_try() const { return left_ > 0 && path_.size() > 2 && !out_of_time_(); }

  double length(const Configuration& a, const Configuration& b) const {
    return weight_.cwiseProduct(b - a).norm();
  }

  /// How much shorter the path is when two places of different edges are joined.
  double gain(const PlaceOnPath& from, const PlaceOnPath& to) const {
    const Configuration start = point_at(path_, from), end = point_at(path_, to);
    double gained = -length(start, end) + length(start, path_[from.edge + 1]) + length(path_[to.edge], end);
    for (std::size_t i = from.edge + 1; i < to.edge; ++i) gained += length(path_[i], path_[i + 1]);
    return gained;
  }

  /// Joins two places if that is free and worth while.
  bool join(const PlaceOnPath& from, const PlaceOnPath& to, double worth) {
    if (from.edge == to.edge || !(gain(from, to) > worth)) return false;
    const Configuration start = point_at(path_, from), end = point_at(path_, to);
    if (!is_free(start, end)) return false;
    std::vector<Configuration> shorter(path_.begin(), at(from.edge + 1));
    if (start != shorter.back()) shorter.push_back(start);
    if (end != path_[to.edge + 1]) shorter.push_back(end);
    shorter.insert(shorter.end(), at(to.edge + 1), path_.end());
    path_ = std::move(shorter);
    return true;
  }

  static constexpr double worth_while = 0.005;  ///< of the path's length

  const ConfigurationSpace& space_;
  const Eigen::VectorXd& weight_;
  std::vector<Configuration> path_;
  std::vector<Edge> refused_;
  bool is_quick_ = false;
  int left_;  ///< tries to cut
  const std::function<bool()>& out_of_time_;
};

}  // namespace

std::vector<Configuration> shortcut(const ConfigurationSpace& space, std::vector<Configuration> path,
                                    const Eigen::VectorXd& weight, std::uint64_t seed, int attempts,
                                    const std::function<bool()>& out_of_time) {
  if (attempts <= 0) return path;
  const WorkMeter::Scope scope(space.meter(), PlanWork::shortcuts);
  if (path.size() <= 2) return path;
  std::mt19937_64 random(seed);
  Shortener shortener(space, std::move(path), weight, attempts, out_of_time);
  shortener.jump();
  shortener.cut(random);
  shortener.cut_corners();
  shortener.jump();
  return std::move(shortener).path();
}

}  // namespace clearway
