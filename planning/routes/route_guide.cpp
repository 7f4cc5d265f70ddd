#include "planning/routes/route_guide.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mapping/system/random_unit.hpp"
#include "planning/robot/bring_point.hpp"
#include "planning/robot/reach.hpp"
#include "planning/routes/free_route.hpp"

namespace clearway {
namespace {

constexpr double most_times = 4.0;  ///< the cheapest route's price; the search for it takes a tenth as long

/// Where the middle of the hand can get, on the map.
Eigen::AlignedBox3d hand_bounds(const ConfigurationSpace& space, const EndEffector& hand) {
  const Robot& robot = space.robot();
  Eigen::AlignedBox3d box = reach_box(robot, robot.bodies[static_cast<std::size_t>(hand.body)]);
  box.min().array() += hand.inner_radius;
  box.max().array() -= hand.inner_radius;
  Eigen::AlignedBox3d map = space.map().bounds();
  if (map.isEmpty()) return map;
  const double margin = hand.requirement.policy == Policy::not_occupied ? 4.0 * hand.outer_radius : 0.0;
  map.min().array() -= margin;
  map.max().array() += margin;
  return box.intersection(map);
}

}  // namespace

EndEffectorRoute find_end_effector_route(const PlanProblem& problem, const EndEffector& hand,
                                         const std::vector<Sphere>& avoided) {
  const ConfigurationSpace& space = problem.space;
  const BlockedSpace& blocked = hand.blocked(space);
  const Eigen::Vector3d from = hand.position(space.robot(), problem.start),
                        to = hand.position(space.robot(), problem.goal);
  const double wide = std::min(hand.outer_radius, blocked.max_distance());
  const auto price = [&](const Eigen::Vector3d& point, double clearance) {
    const double narrow = std::max(0.0, 1.0 - clearance / wide);
    const bool is_avoided = std::any_of(avoided.begin(), avoided.end(), [&](const Sphere& sphere) {
      return (sphere.center - point).norm() < sphere.radius;
    });
    return (1.0 + 30.0 * narrow) * (is_avoided ? 20.0 : 1.0);
  };
  if (hand.requirement.policy == Policy::painted) {
    const PaintedGraph graph(space.map(), hand.requirement.volumes, 0.0, problem.out_of_time);
    EndEffectorRoute route = graph.route(
        from, to, [&](const Eigen::Vector3d& point) { return price(point, blocked.clearance(point)); });
    if (!route.points.empty()) return route;
  }
  const auto of_cells = [&](double cell) {
    return free_route(blocked, hand_bounds(space, hand), from, to, hand.inner_radius, cell, price,
                      problem.out_of_time, most_times);
  };
  // Cells no wider than the hand's radius skip no wall. Coarse ones are an eighth as many, but may miss a
  // gap.
  const double voxel = space.map().resolution(), widest = std::max(voxel, hand.inner_radius);
  const double coarse = std::min(4.0 * voxel, widest), fine = std::min(2.0 * voxel, widest);
  EndEffectorRoute route = of_cells(coarse);
  return route.points.empty() && fine < coarse ? of_cells(fine) : route;
}

RouteGuide::RouteGuide(const PlanProblem& problem, const EndEffector& hand, EndEffectorRoute route,
                       double share)
    : robot_(&problem.space.robot()),
      hand_(hand),
      start_(problem.start),
      goal_(problem.goal),
      route_(std::move(route)),
      share_(share) {
  double length = 0.0;
  for (std::size_t i = 0; i < route_.points.size(); ++i) {
    if (i > 0) length += (route_.points[i] - route_.points[i - 1]).norm();
    along_.push_back(length);
  }
}

std::optional<Configuration> RouteGuide::operator()(std::mt19937_64& random) const {
  if (route_.points.size() < 2 || random_unit(random) >= share_) return std::nullopt;
  const double share = random_unit(random), wanted = share * along_.back();
  const auto next = std::upper_bound(along_.begin() + 1, along_.end() - 1, wanted);
  const auto i = static_cast<std::size_t>(next - along_.begin());
  const double piece = along_[i] - along_[i - 1];
  const double t = piece > 0.0 ? (wanted - along_[i - 1]) / piece : 0.0;
  Eigen::Vector3d target = route_.points[i - 1] + t * (route_.points[i] - route_.points[i - 1]);
  const double radius = hand_.outer_radius, play = std::max(0.25 * radius, 0.5 * (route_.radii[i] - radius));
  for (int k = 0; k < 3; ++k) target[k] += play * (2.0 * random_unit(random) - 1.0);

  // Half of the tries stay near the straight way in joint space, the others may turn the arm over.
  const bool near = random_unit(random) < 0.5;
  Configuration q = start_ + share * (goal_ - start_);
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Joint& joint = robot_->joints[static_cast<std::size_t>(j)];
    const double half = joint.kind == JointKind::revolute ? std::numbers::pi : 1.0;
    const double lower = std::max(joint.lower, q[j] - half), upper = std::min(joint.upper, q[j] + half);
    const double drawn = lower + (upper - lower) * random_unit(random);
    q[j] = std::clamp(near ? q[j] + 0.25 * (drawn - q[j]) : drawn, joint.lower, joint.upper);
  }
  constexpr int most_steps = 8;
  thread_local LinkPoses poses;
  if (!bring_point(*robot_, {hand_.link, hand_.center, target, 0.1 * play}, most_steps, q, poses))
    return std::nullopt;
  return q;
}

}  // namespace clearway
