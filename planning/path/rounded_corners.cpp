#include "planning/path/rounded_corners.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

using Path = std::vector<Configuration>;

constexpr double nearest = 1e-9;  ///< weighted: between two points of the result
constexpr int most_pieces = 64;   ///< of an arc

/// Angle between a - b and c - b, taken from pi.
double turn_at(const Configuration& a, const Configuration& b, const Configuration& c,
               const Eigen::VectorXd& weight) {
  const Eigen::VectorXd in = weight.cwiseProduct(b - a), out = weight.cwiseProduct(c - b);
  const double lengths = in.norm() * out.norm();
  return lengths > 0.0 ? std::acos(std::clamp(in.dot(out) / lengths, -1.0, 1.0)) : 0.0;
}

class Rounder {
 public:
  Rounder(const PlanProblem& problem, const Eigen::VectorXd& weight, const RoundingOptions& options,
          std::uint64_t& edges_checked)
      : problem_(problem), weight_(weight), options_(options), edges_checked_(edges_checked) {}

  /// The arc at a corner, or nothing. @pre the edges before - corner and corner - next are certified, and so
  /// is last - corner.
  /// @param is_on_edge `last` is on the edge before - corner, so that any part of what lies between is
  /// certified
  Path arc(const Configuration& before, const Configuration& last, const Configuration& corner,
           const Configuration& next, bool is_on_edge) {
    const double turn = turn_at(before, corner, next, weight_);
    if (turn <= options_.turn) return {};
    const double in = length(before, corner), out = length(corner, next);
    double reach = std::min({options_.longest, 0.5 * in, 0.5 * out});
    for (int halving = 0; halving <= options_.halvings && reach > nearest; ++halving, reach *= 0.5) {
      if (problem_.out_of_time()) return {};
      Path points = bezier(corner + (reach / in) * (before - corner), corner,
                           corner + (reach / out) * (next - corner), turn);
      if (are_one(last, points.front())) points.front() = last;  // two arcs meet in the middle of an edge
      const bool is_reached = is_on_edge || points.front() == last || is_free(last, points.front());
      if (is_reached && is_allowed(points, corner)) return points;
    }
    return {};
  }

  /// Whether a waypoint without an arc can be left out as good as the same as the one before it.
  bool is_spare(const Configuration& last, const Configuration& corner, const Configuration& next) {
    return are_one(last, corner) && (last == corner || is_free(last, next));
  }

  /// Adds the last waypoint, in the place of a point that is as good as the same.
  void finish(Path& path, const Configuration& end) {
    const std::size_t n = path.size();
    if (n > 1 && are_one(path.back(), end) && (path.back() == end || is_free(path[n - 2], end)))
      path.pop_back();
    path.push_back(end);
  }

 private:
  double length(const Configuration& a, const Configuration& b) const {
    return weight_.cwiseProduct(b - a).norm();
  }

  bool are_one(const Configuration& a, const Configuration& b) const { return length(a, b) < nearest; }

  Path bezier(const Configuration& from, const Configuration& corner, const Configuration& to,
              double turn) const {
    // Edges of an arc point like points spaced evenly between two unit vectors `turn` apart.
    const double wanted = std::ceil(2.0 * std::tan(std::min(0.5 * turn, 1.57)) / options_.turn);
    const int pieces = static_cast<int>(std::clamp(wanted, 2.0, static_cast<double>(most_pieces)));
    Path points{from};
    for (int k = 1; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces, s = 1.0 - t;
      Configuration q = s * s * from + 2.0 * s * t * corner + t * t * to;
      if (!are_one(points.back(), q) && !are_one(q, to)) points.push_back(std::move(q));
    }
    points.push_back(to);
    return points;
  }

  bool is_free(const Configuration& from, const Configuration& to) {
    ++edges_checked_;
    return problem_.space.is_edge_free(from, to);
  }

  /// What is left of the two edges is certified as they are.
  bool is_allowed(const Path& points, const Configuration& corner) {
    for (std::size_t i = 1; i < points.size(); ++i) {
      ++edges_checked_;
      if (!problem_.space.is_edge_quickly_free(points[i - 1], points[i])) return false;
    }
    const double least = problem_.space.clearance(corner, options_.least_clearance);
    return std::all_of(points.begin() + 1, points.end() - 1,
                       [&](const Configuration& q) { return problem_.space.clearance(q, least) >= least; });
  }

  const PlanProblem& problem_;
  const Eigen::VectorXd& weight_;
  const RoundingOptions& options_;
  std::uint64_t& edges_checked_;
};

}  // namespace

std::vector<Configuration> rounded_corners(const PlanProblem& problem, const std::vector<Configuration>& path,
                                           const Eigen::VectorXd& weight, const RoundingOptions& options,
                                           std::uint64_t& edges_checked) {
  const WorkMeter::Scope scope(problem.space.meter(), PlanWork::shortcuts);
  if (path.size() < 3) return path;
  Rounder rounder(problem, weight, options, edges_checked);
  Path rounded{path.front()};
  bool is_on_edge = true;  // the last point of the result, on the edge that ends at the corner
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Path arc = rounder.arc(path[i - 1], rounded.back(), path[i], path[i + 1], is_on_edge);
    const bool is_left_out = arc.empty() && rounder.is_spare(rounded.back(), path[i], path[i + 1]);
    if (arc.empty() && !is_left_out) rounded.push_back(path[i]);
    is_on_edge = !is_left_out || rounded.back() == path[i];
    for (const Configuration& q : arc)
      if (q != rounded.back()) rounded.push_back(q);
  }
  rounder.finish(rounded, path.back());
  return rounded;
}

double sharpest_turn(const std::vector<Configuration>& path, const Eigen::VectorXd& weight) {
  double sharpest = 0.0;
  for (std::size_t i = 2; i < path.size(); ++i)
    sharpest = std::max(sharpest, turn_at(path[i - 2], path[i - 1], path[i], weight));
  return sharpest;
}

}  // namespace clearway
