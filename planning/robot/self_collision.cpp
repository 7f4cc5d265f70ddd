#include "planning/robot/self_collision.hpp"

#include <algorithm>

#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

std::vector<bool> is_above(const Robot& robot, int link) {
  std::vector<bool> above(robot.links.size(), false);
  for (int i = link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent)
    above[static_cast<std::size_t>(i)] = true;
  return above;
}

/// Levers of the links that move `body` but not `other`.
void add_levers(const Robot& robot, const Body& body, const Body& other, Eigen::VectorXd& sum) {
  const std::vector<bool> shared = is_above(robot, other.link);
  for (int i = body.link; i >= 0 && !shared[static_cast<std::size_t>(i)];
       i = robot.links[static_cast<std::size_t>(i)].parent) {
    const Link& link = robot.links[static_cast<std::size_t>(i)];
    if (link.joint >= 0) sum[link.joint] += std::abs(link.multiplier) * lever(robot, i, body);
  }
}

/// Whether a joint that is held still hangs between `body` and what it shares with `other`.
bool is_held_apart(const Robot& robot, const Body& body, const Body& other) {
  const std::vector<bool> shared = is_above(robot, other.link);
  for (int i = body.link; i >= 0 && !shared[static_cast<std::size_t>(i)];
       i = robot.links[static_cast<std::size_t>(i)].parent)
    if (robot.links[static_cast<std::size_t>(i)].is_held) return true;
  return false;
}

Eigen::Isometry3d placed(const Body& body, const LinkPoses& map_from_link) {
  return map_from_link[static_cast<std::size_t>(body.link)] * body.link_from_shape;
}

}  // namespace

std::vector<BodyPair> self_collision_pairs(const Robot& robot) {
  std::vector<BodyPair> pairs;
  for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b) {
      if (std::find(robot.exempt.begin(), robot.exempt.end(), std::pair(a, b)) != robot.exempt.end())
        continue;
      BodyPair pair{a, b, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot.dof()))};
      const Body& first = robot.bodies[static_cast<std::size_t>(a)];
      const Body& second = robot.bodies[static_cast<std::size_t>(b)];
      add_levers(robot, first, second, pair.approach);
      add_levers(robot, second, first, pair.approach);
      const bool may_touch = (pair.approach.array() > 0.0).any() || is_held_apart(robot, first, second) ||
                             is_held_apart(robot, second, first);
      if (may_touch) pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

DistanceBounds pair_distance(const Robot& robot, const BodyPair& pair, const LinkPoses& map_from_link,
                             double enough) {
  const Body& a = robot.bodies[static_cast<std::size_t>(pair.first)];
  const Body& b = robot.bodies[static_cast<std::size_t>(pair.second)];
  return distance(a.shape, placed(a, map_from_link), b.shape, placed(b, map_from_link), enough);
}

double pair_distance_bound(const Robot& robot, const BodyPair& pair, const LinkPoses& map_from_link,
                           double enough) {
  const Body& a = robot.bodies[static_cast<std::size_t>(pair.first)];
  const Body& b = robot.bodies[static_cast<std::size_t>(pair.second)];
  const Eigen::Isometry3d pose_a = placed(a, map_from_link), pose_b = placed(b, map_from_link);
  const double centers = (pose_a.translation() - pose_b.translation()).norm() * (1.0 - 1e-9);
  const double spheres = centers - a.shape.bounding_radius() - b.shape.bounding_radius();
  return spheres > enough ? spheres : distance(a.shape, pose_a, b.shape, pose_b).lower;
}

bool is_apart(const Robot& robot, const BodyPair& pair, const LinkPoses& map_from_link, double margin) {
  const Body& a = robot.bodies[static_cast<std::size_t>(pair.first)];
  const Body& b = robot.bodies[static_cast<std::size_t>(pair.second)];
  const Eigen::Isometry3d pose_a = placed(a, map_from_link), pose_b = placed(b, map_from_link);
  const double reach = a.shape.bounding_radius() + b.shape.bounding_radius() + margin;
  const double squared = (pose_a.translation() - pose_b.translation()).squaredNorm();
  if (squared > reach * reach * (1.0 + 1e-9)) return true;
  return distance(a.shape, pose_a, b.shape, pose_b, margin).lower > margin;
}

}  // namespace clearway
