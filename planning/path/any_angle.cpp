#include "planning/path/any_angle.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "mapping/system/random_unit.hpp"
#include "planning/path/path_pieces.hpp"

namespace clearway {
namespace {

using Path = std::vector<Configuration>;

/// What each joint's motion along an edge costs, sampled at pieces no longer than `step`, joules.
Eigen::VectorXd edge_costs(const PathCost& cost, const Configuration& from, const Configuration& to,
                           const Eigen::VectorXd& weight, double step) {
  const Eigen::VectorXd whole = to - from;
  const int pieces = std::max(1, static_cast<int>(std::ceil(weight.cwiseProduct(whole).norm() / step)));
  Eigen::VectorXd forces = 0.5 * (cost.generalized_forces(from) + cost.generalized_forces(to));
  for (int k = 1; k < pieces; ++k)
    forces += cost.generalized_forces(from + static_cast<double>(k) / pieces * whole);
  return forces.cwiseProduct(cost.full_size(whole).cwiseAbs()) / pieces;
}

/// Everything that the attempts share.
struct Pass {
  const PlanProblem& problem;
  const Eigen::VectorXd& weight;
  double cost_step;
  std::uint64_t& edges_checked;

  bool is_free(const Configuration& from, const Configuration& to) const {
    ++edges_checked;
    return problem.space.is_edge_free(from, to);
  }
  bool is_quickly_free(const Configuration& from, const Configuration& to) const {
    ++edges_checked;
    return problem.space.is_edge_quickly_free(from, to);
  }
  Eigen::VectorXd costs(const Configuration& from, const Configuration& to, double times = 1.0) const {
    return edge_costs(problem.cost, from, to, weight, times * cost_step);
  }
  double cost(const Path& path) const { return sampled_cost(problem.cost, path, weight, cost_step); }
  double length(const Configuration& a, const Configuration& b) const {
    return weight.cwiseProduct(b - a).norm();
  }
};

/// From each waypoint straight to the farthest one that doubling and then halving the jump finds free.
Path jumped(const Pass& pass, const Path& path) {
  Path jumped{path.front()};
  std::size_t at = 0;
  const std::size_t end = path.size() - 1;
  while (at < end) {
    std::size_t good = at + 1, bad = end + 1, jump = 2;
    while (good < end && !pass.problem.out_of_time()) {  // double
      const std::size_t to = std::min(end, at + jump);
      if (!pass.is_free(path[at], path[to])) {
        bad = to;
        break;
      }
      good = to;
      jump *= 2;
    }
    while (bad - good > 1 && bad <= end && !pass.problem.out_of_time()) {  // halve
      const std::size_t middle = (good + bad) / 2;
      (pass.is_free(path[at], path[middle]) ? good : bad) = middle;
    }
    at = good;
    jumped.push_back(path[at]);
  }
  return jumped;
}

/// The piece of the path between two places: the places themselves and the waypoints between them.
Path piece(const Path& path, const PlaceOnPath& from, const PlaceOnPath& to) {
  Path points{point_at(path, from)};
  for (std::size_t i = from.edge + 1; i <= to.edge; ++i) {
    if (path[i] != points.back()) points.push_back(path[i]);
  }
  const Configuration end = point_at(path, to);
  if (end != points.back()) points.push_back(end);
  return points;
}

/// Joint `joint` of the piece goes evenly (by length of the piece) from its first to its last value.
Path with_even_joint(const Pass& pass, Path points, Eigen::Index joint) {
  std::vector<double> along{0.0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    along.push_back(along.back() + pass.length(points[i - 1], points[i]));
  }
  const double from = points.front()[joint], to = points.back()[joint];
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    points[i][joint] = from + (to - from) * (along.back() > 0.0 ? along[i] / along.back() : 0.0);
  }
  return points;
}

/// Joint `joint` of the piece stays between its first and last value.
Path with_clamped_joint(Path points, Eigen::Index joint) {
  const auto [low, high] = std::minmax({points.front()[joint], points.back()[joint]});
  for (Configuration& q : points) q[joint] = std::clamp(q[joint], low, high);
  return points;
}

/// A path that random attempts make cheaper. Parts of certified edges are certified.
class CheaperPath {
 public:
  CheaperPath(const Pass& pass, Path path) : pass_(pass), path_(std::move(path)) {
    for (std::size_t i = 1; i < path_.size(); ++i) costs_.push_back(pass_.costs(path_[i - 1], path_[i]));
  }

  std::size_t size() const { return path_.size(); }
  Path path() && { return std::move(path_); }

  /// One random attempt; true when the path became cheaper.
  bool try_cut(std::mt19937_64& random) {
    const auto uniform = [&random] { return random_unit(random); };
    const std::vector<double> lengths = edge_lengths(path_, pass_.weight);
    const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    const double a = whole * uniform(), b = whole * uniform(), kind = 3.0 * uniform(), share = uniform();
    const PlaceOnPath from = place_at(lengths, std::min(a, b)), to = place_at(lengths, std::max(a, b));
    if (from.edge == to.edge) return false;
    const Path old = piece(path_, from, to);
    const Eigen::VectorXd before =
        std::accumulate(costs_.begin() + at(from.edge), costs_.begin() + at(to.edge) + 1,
                        Eigen::VectorXd(Eigen::VectorXd::Zero(old.front().size())));
    const Eigen::Index joint = drawn_joint(before, share);
    const Path cut = kind < 1.0   ? Path{old.front(), old.back()}
                     : kind < 2.0 ? with_even_joint(pass_, old, joint)
                                  : with_clamped_joint(old, joint);
    return replace(from.edge, to.edge, cut, before.sum());
  }

 private:
  static std::ptrdiff_t at(std::size_t index) { return static_cast<std::ptrdiff_t>(index); }

  /// Joints in proportion to what they cost on the path: a heavy one is worth more attempts.
  static Eigen::Index drawn_joint(const Eigen::VectorXd& costs, double share) {
    const Eigen::VectorXd least = Eigen::VectorXd::Constant(costs.size(), 1e-9);
    double left = share * (costs + least).sum();
    Eigen::Index joint = 0;
    while (joint + 1 < costs.size() && left >= costs[joint] + 1e-9) left -= costs[joint++] + 1e-9;
    return joint;
  }

  /// Replaces the edges from `first` to `last` by those to, along and from the cut, if that is free and
  /// cheaper than `before`. Whole edges are compared: their samples are what the path's cost is made of.
  bool replace(std::size_t first, std::size_t last, const Path& cut, double before) {
    Path after{path_[first]};
    for (const Configuration& q : cut) {
      if (q != after.back()) after.push_back(q);
    }
    if (path_[last + 1] != after.back()) after.push_back(path_[last + 1]);
    constexpr double coarse = 4.0;  // most attempts fail, and this finds most of them
    double rough = 0.0;
    for (std::size_t i = 1; i < after.size() && rough < before; ++i)
      rough += pass_.costs(after[i - 1], after[i], coarse).sum();
    if (rough >= before) return false;
    for (std::size_t i = 1; i < cut.size(); ++i) {
      if (!pass_.is_quickly_free(cut[i - 1], cut[i])) return false;
    }
    std::vector<Eigen::VectorXd> costs;
    double cost = 0.0;
    for (std::size_t i = 1; i < after.size(); ++i) {
      costs.push_back(pass_.costs(after[i - 1], after[i]));
      cost += costs.back().sum();
    }
    if (cost >= before * (1.0 - 1e-9)) return false;
    path_.erase(path_.begin() + at(first), path_.begin() + at(last) + 2);
    path_.insert(path_.begin() + at(first), after.begin(), after.end());
    costs_.erase(costs_.begin() + at(first), costs_.begin() + at(last) + 1);
    costs_.insert(costs_.begin() + at(first), costs.begin(), costs.end());
    return true;
  }

  const Pass& pass_;
  Path path_;
  std::vector<Eigen::VectorXd> costs_;  ///< of each edge, a value for each joint
};

}  // namespace

double sampled_cost(const PathCost& cost, const std::vector<Configuration>& path,
                    const Eigen::VectorXd& weight, double step) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i)
    sum += edge_costs(cost, path[i - 1], path[i], weight, step).sum();
  return sum;
}

std::vector<Configuration> straightened(const PlanProblem& problem, std::vector<Configuration> path,
                                        const Eigen::VectorXd& weight, const AnyAngleOptions& options,
                                        std::uint64_t& edges_checked) {
  const WorkMeter::Scope scope(problem.space.meter(), PlanWork::shortcuts);
  if (path.size() < 3) return path;
  const Pass pass{problem, weight, options.cost_step, edges_checked};
  Path direct = jumped(pass, path);
  if (pass.cost(direct) <= pass.cost(path)) path = std::move(direct);
  std::mt19937_64 random(problem.seed);
  CheaperPath cheaper(pass, std::move(path));
  for (int attempt = 0, in_vain = 0; attempt < options.attempts && cheaper.size() > 2; ++attempt) {
    if (in_vain == options.patience || problem.out_of_time()) break;
    in_vain = cheaper.try_cut(random) ? 0 : in_vain + 1;
  }
  return std::move(cheaper).path();
}

}  // namespace clearway
