#include "planning/routes/route_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mapping/system/random_unit.hpp"
#include "planning/robot/bring_point.hpp"

namespace clearway {
namespace {

constexpr int fewest_steps = 4,
              most_steps = 200;  ///< that a route is divided into; else the hand's radius each
constexpr double behind = 0.4;   ///< chance to begin a place farther back, and again
constexpr double least_spread = 0.02, most_spread = 1.5;  ///< rad
constexpr double wider = 1.1, narrower = 0.7;             ///< after a blocked step and after a free one

/// So many points, evenly spaced along the route, both of its ends among them.
std::vector<Eigen::Vector3d> spaced(const std::vector<Eigen::Vector3d>& points, double length, int steps) {
  std::vector<Eigen::Vector3d> way{points.front()};
  double begin = 0.0;  // of the piece before point i
  std::size_t i = 1;
  for (int k = 1; k < steps; ++k) {
    const double wanted = length * k / steps;
    double piece = (points[i] - points[i - 1]).norm();
    while (i + 1 < points.size() && begin + piece < wanted) {
      begin += piece;
      ++i;
      piece = (points[i] - points[i - 1]).norm();
    }
    const double share = piece > 0.0 ? std::clamp((wanted - begin) / piece, 0.0, 1.0) : 0.0;
    way.push_back(points[i - 1] + share * (points[i] - points[i - 1]));
  }
  way.push_back(points.back());
  return way;
}

}  // namespace

RouteWalk::RouteWalk(const Robot& robot, const EndEffector& hand, const EndEffectorRoute& route)
    : robot_(&robot), hand_(hand) {
  double length = 0.0;
  for (std::size_t i = 1; i < route.points.size(); ++i)
    length += (route.points[i] - route.points[i - 1]).norm();
  const double step = std::max(hand.outer_radius, length / most_steps);
  const int steps =
      step > 0.0 ? std::clamp(static_cast<int>(length / step), fewest_steps, most_steps) : fewest_steps;
  way_ = spaced(route.points, length, steps);
  near_ = std::max(length / steps, *std::max_element(route.radii.begin(), route.radii.end()));
  for (Front& front : fronts_) front.nodes.resize(way_.size());
}

void RouteWalk::add(End end, int node, const Configuration& q) {
  const Eigen::Vector3d at = hand_.position(*robot_, q);
  const auto nearest = std::min_element(way_.begin(), way_.end(), [&](const auto& a, const auto& b) {
    return (a - at).squaredNorm() < (b - at).squaredNorm();
  });
  if ((*nearest - at).norm() > near_) return;
  const auto place = static_cast<int>(nearest - way_.begin());
  Front& front = fronts_[end];
  front.nodes[static_cast<std::size_t>(place)].push_back(node);
  if (front.foremost < 0 || (end == start ? place > front.foremost : place < front.foremost))
    front.foremost = place;
}

std::optional<RouteWalk::From> RouteWalk::choose(End end, std::mt19937_64& random) const {
  const Front& front = fronts_[end];
  if (front.foremost < 0) return std::nullopt;
  const auto nodes = [&](int place) -> const std::vector<int>& {
    return front.nodes[static_cast<std::size_t>(place)];
  };
  int place = front.foremost;
  while (random_unit(random) < behind) {
    int back = before(end, place);
    while (is_place(back) && nodes(back).empty()) back = before(end, back);
    if (!is_place(back)) break;
    place = back;
  }
  const std::vector<int>& there = nodes(place);
  const auto drawn = static_cast<std::size_t>(random_unit(random) * static_cast<double>(there.size()));
  return From{there[drawn], place};
}

std::optional<Configuration> RouteWalk::step(End end, const From& from, const Configuration& q,
                                             std::mt19937_64& random) {
  const double spread = fronts_[end].spread;
  Configuration to = q;
  for (Eigen::Index j = 0; j < to.size(); ++j) {
    const Joint& joint = robot_->joints[static_cast<std::size_t>(j)];
    const double most = joint.kind == JointKind::revolute ? spread : spread / std::numbers::pi;
    to[j] = std::clamp(q[j] + most * (2.0 * random_unit(random) - 1.0), joint.lower, joint.upper);
  }
  const int ahead = std::clamp(next(end, from.place), 0, places() - 1);
  const double play = 0.25 * hand_.outer_radius;
  Eigen::Vector3d target = way_[static_cast<std::size_t>(ahead)];
  for (int k = 0; k < 3; ++k) target[k] += play * (2.0 * random_unit(random) - 1.0);
  constexpr int tries = 8;
  thread_local LinkPoses poses;
  if (bring_point(*robot_, {hand_.link, hand_.center, target, play}, tries, to, poses)) return to;
  learn(end, false);
  return std::nullopt;
}

void RouteWalk::learn(End end, bool is_free) {
  double& spread = fronts_[end].spread;
  spread = std::clamp(spread * (is_free ? narrower : wider), least_spread, most_spread);
}

}  // namespace clearway
