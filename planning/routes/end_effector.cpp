#include "planning/routes/end_effector.hpp"

#include <stdexcept>

#include "planning/robot/reach.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

/// How near the tip a link is on its own chain: 0 for the tip's link, 1 for its parent; -1 when not on it.
int steps_from_tip(const Robot& robot, int link) {
  int steps = 0;
  for (int i = robot.tip_link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent, ++steps) {
    if (i == link) return steps;
  }
  return -1;
}

}  // namespace

Eigen::Vector3d EndEffector::position(const Robot& robot, const Configuration& q) const {
  thread_local LinkPoses poses;
  forward_kinematics(robot, q, poses);
  return poses[static_cast<std::size_t>(link)] * center;
}

EndEffector find_end_effector(const ConfigurationSpace& space) {
  const Robot& robot = space.robot();
  int chosen = -1, nearest = 0;
  bool is_painted = false;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    if (!is_moved(robot, body.link)) continue;
    const bool painted = space.policies().at(body.part) == Policy::painted;
    int steps = steps_from_tip(robot, body.link);
    if (steps < 0) steps = static_cast<int>(robot.links.size());  // a finger, a load on a branch of its own
    if (chosen >= 0 && (is_painted != painted ? is_painted : nearest <= steps)) continue;
    chosen = static_cast<int>(i), nearest = steps, is_painted = painted;
  }
  if (chosen < 0) throw std::invalid_argument("robot " + robot.name + " has no body that a joint moves");
  const Body& body = robot.bodies[static_cast<std::size_t>(chosen)];
  EndEffector hand;
  hand.body = chosen;
  hand.link = body.link;
  hand.center = body.link_from_shape.translation();
  if (body.shape.has_exact_distance())
    hand.inner_radius = std::max(0.0, -body.shape.signed_distance(Eigen::Vector3d::Zero()));
  hand.outer_radius = body.shape.bounding_radius();
  hand.requirement = part_requirement(robot, space.map(), body.part, space.policies().at(body.part),
                                      space.options().seen_within);
  return hand;
}

}  // namespace clearway
