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

/// Joints in proportion to what they cost on the path: a heavy one is worth more attempts.
Eigen::Index drawn_joint(const Pass& pass, const Path& points, double share) {
  Eigen::VectorXd costs = Eigen::VectorXd::Constant(points.front().size(), 1e-9);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::VectorXd forces = pass.problem.cost.generalized_forces(points[i]);
    costs += forces.cwiseProduct((points[i] - points[i - 1]).cwiseAbs());
  }
  double left = share * costs.sum();
  Eigen::Index joint = 0;
  while (joint + 1 < costs.size() && left >= costs[joint]) left -= costs[joint++];
  return joint;
}

/// The path with its part between two places replaced. Pieces left of the cut edges are certified anew: a
/// piece of a free edge need not prove as easily.
bool is_replaceable(const Pass& pass, const Path& path, const PlaceOnPath& from, const PlaceOnPath& to,
                    const Path& points) {
  if (points.front() != path[from.edge] && !pass.is_free(path[from.edge], points.front())) return false;
  if (points.back() != path[to.edge + 1] && !pass.is_free(points.back(), path[to.edge + 1])) return false;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!pass.is_free(points[i - 1], points[i])) return false;
  }
  return true;
}

Path replaced(const Path& path, const PlaceOnPath& from, const PlaceOnPath& to, const Path& points) {
  Path result(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(from.edge) + 1);
  const auto add = [&](const Configuration& q) {
    if (q != result.back()) result.push_back(q);
  };
  for (const Configuration& q : points) add(q);
  for (std::size_t i = to.edge + 1; i < path.size(); ++i) add(path[i]);
  return result;
}

/// One random attempt; true when the path became cheaper.
bool try_cut(const Pass& pass, Path& path, std::mt19937_64& random) {
  const auto uniform = [&random] { return random_unit(random); };
  const std::vector<double> lengths = edge_lengths(path, pass.weight);
  const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  const double a = whole * uniform(), b = whole * uniform(), kind = 3.0 * uniform(), share = uniform();
  const PlaceOnPath from = place_at(lengths, std::min(a, b)), to = place_at(lengths, std::max(a, b));
  if (from.edge == to.edge) return false;
  const Path old = piece(path, from, to);
  const Eigen::Index joint = drawn_joint(pass, old, share);
  const Path cut = kind < 1.0   ? Path{old.front(), old.back()}
                   : kind < 2.0 ? with_even_joint(pass, old, joint)
                                : with_clamped_joint(old, joint);
  // Whole edges are compared: their samples are what the path's cost is made of.
  const Path before(path.begin() + static_cast<std::ptrdiff_t>(from.edge),
                    path.begin() + static_cast<std::ptrdiff_t>(to.edge) + 2);
  Path after{before.front()};
  after.insert(after.end(), cut.begin(), cut.end());
  after.push_back(before.back());
  if (pass.cost(after) >= pass.cost(before) * (1.0 - 1e-9)) return false;
  if (!is_replaceable(pass, path, from, to, cut)) return false;
  path = replaced(path, from, to, cut);
  return true;
}

}  // namespace

double sampled_cost(const PathCost& cost, const std::vector<Configuration>& path,
                    const Eigen::VectorXd& weight, double step) {
  if (path.size() < 2) return 0.0;
  double sum = 0.0;
  Eigen::VectorXd before = cost.generalized_forces(path.front());
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::VectorXd whole = path[i] - path[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(weight.cwiseProduct(whole).norm() / step)));
    const Eigen::VectorXd part = whole / pieces;
    for (int k = 1; k <= pieces; ++k) {
      const Eigen::VectorXd after = cost.generalized_forces(k < pieces ? path[i - 1] + k * part : path[i]);
      sum += cost.step_cost(before, after, part);
      before = after;
    }
  }
  return sum;
}

std::vector<Configuration> straightened(const PlanProblem& problem, std::vector<Configuration> path,
                                        const Eigen::VectorXd& weight, const AnyAngleOptions& options,
                                        std::uint64_t& edges_checked) {
  if (path.size() < 3) return path;
  const Pass pass{problem, weight, options.cost_step, edges_checked};
  Path direct = jumped(pass, path);
  if (pass.cost(direct) <= pass.cost(path)) path = std::move(direct);
  std::mt19937_64 random(problem.seed);
  for (int attempt = 0, in_vain = 0; attempt < options.attempts && path.size() > 2; ++attempt) {
    if (in_vain == options.patience || problem.out_of_time()) break;
    in_vain = try_cut(pass, path, random) ? 0 : in_vain + 1;
  }
  return path;
}

}  // namespace clearway
