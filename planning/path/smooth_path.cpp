#include "planning/path/smooth_path.hpp"

#include <algorithm>

namespace clearway {
namespace {

/// A straight rest of an edge that is shorter than this share of it is none.
constexpr double least_share = 1e-9;

void add_straight(SmoothPath& path, const Configuration& from, const Configuration& to, double cut_from,
                  double cut_to) {
  const Eigen::VectorXd step = to - from;
  const double length = step.norm(), rest = length - cut_from - cut_to;
  if (rest <= least_share * length) return;
  path.pieces.push_back({.begin = from + (cut_from / length) * step,
                         .direction = step / length,
                         .bend = Eigen::VectorXd::Zero(step.size()),
                         .length = rest});
}

}  // namespace

double SmoothPath::length() const {
  double sum = 0.0;
  for (const PathPiece& piece : pieces) sum += piece.length;
  return sum;
}

SmoothPath blended_path(const std::vector<Configuration>& waypoints, const std::vector<double>& reach) {
  SmoothPath path{{}, waypoints.front(), waypoints.back()};
  const std::size_t last = waypoints.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const double cut_from = i == 0 ? 0.0 : reach[i], cut_to = i + 1 == last ? 0.0 : reach[i + 1];
    add_straight(path, waypoints[i], waypoints[i + 1], cut_from, cut_to);
    if (i + 1 == last) break;
    const Eigen::VectorXd in = (waypoints[i + 1] - waypoints[i]).normalized(),
                          out = (waypoints[i + 2] - waypoints[i + 1]).normalized();
    path.pieces.push_back({.begin = waypoints[i + 1] - cut_to * in,
                           .direction = in,
                           .bend = (out - in) / (2.0 * cut_to),
                           .length = 2.0 * cut_to,
                           .corner = i + 1});
  }
  return path;
}

}  // namespace clearway
