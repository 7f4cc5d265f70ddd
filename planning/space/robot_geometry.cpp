#include "planning/space/robot_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "planning/robot/last_made.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot/same_robot.hpp"
#include "planning/space/axisymmetric_joints.hpp"

namespace clearway {
namespace {

/// For each joint how fast it turns the links of the body's chain, all added up; 0 for one that slides.
Eigen::VectorXd body_turns(const Robot& robot, const Body& body) {
  Eigen::VectorXd turns = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (int i = body.link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
    const Link& link = robot.links[static_cast<std::size_t>(i)];
    if (link.joint < 0) continue;
    const bool slides = kind_of(robot, link) == JointKind::prismatic;
    if (!slides) turns[link.joint] += std::abs(link.multiplier);
  }
  return turns;
}

/// without_axisymmetric_joints, but where bodies that touch in every configuration would end up on one link:
/// these stay where they are, so that their contact still counts.
Robot reduced(const Robot& given) {
  Robot robot = without_axisymmetric_joints(given);
  const auto is_where_it_was = [](const Body& a, const Body& b) { return a.link == b.link; };
  if (std::equal(robot.bodies.begin(), robot.bodies.end(), given.bodies.begin(), is_where_it_was))
    return robot;
  const std::vector<BodyPair> wanted = self_collision_pairs(given);
  const LinkPoses poses =  // any will do: no joint changes how far bodies of one link are apart
      forward_kinematics(given, Configuration::Zero(static_cast<Eigen::Index>(given.dof())));
  for (bool changed = true; changed;) {  // a body put back may leave another one's pair without motion
    changed = false;
    const std::vector<BodyPair> kept = self_collision_pairs(robot);
    for (const BodyPair& pair : wanted) {
      const bool is_kept = std::any_of(kept.begin(), kept.end(), [&](const BodyPair& other) {
        return other.first == pair.first && other.second == pair.second;
      });
      if (is_kept || is_apart(given, pair, poses, 0.0)) continue;
      for (const int body : {pair.first, pair.second})
        robot.bodies[static_cast<std::size_t>(body)] = given.bodies[static_cast<std::size_t>(body)];
      changed = true;
    }
  }
  return robot;
}

/// A joint that slides without limits below joints that turn: how far these move the robot has no bound, and
/// no bound times a joint that stands still is no number.
void refuse_unlimited_reach(const Robot& robot, const std::vector<const Eigen::VectorXd*>& rates) {
  if (std::all_of(rates.begin(), rates.end(), [](const auto* rate) { return rate->allFinite(); })) return;
  for (const Link& link : robot.links) {
    if (link.joint < 0 || kind_of(robot, link) == JointKind::revolute) continue;
    const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
    if (std::isfinite(joint.lower) && std::isfinite(joint.upper)) continue;
    throw std::invalid_argument("robot " + robot.name + ": joint " + quote(joint.name) +
                                " slides without limits below joints that turn: expected joint limits");
  }
  throw std::invalid_argument("robot " + robot.name + ": expected links of finite lengths");
}

/// @param given kept with what is made of it
RobotGeometry made_of(const Robot& given) {
  RobotGeometry geometry{given, reduced(given), {}, {}, {}};
  const Robot& robot = geometry.robot;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    if (!is_policed(robot, body.link)) continue;
    geometry.policed.push_back({static_cast<int>(i), std::make_shared<const BodyGeometry>(body),
                                reach_box(robot, body), body_levers(robot, body), body_turns(robot, body)});
  }
  geometry.pairs = self_collision_pairs(robot);
  std::vector<const Eigen::VectorXd*> rates;
  for (const RobotGeometry::Policed& policed : geometry.policed) rates.push_back(&policed.levers);
  for (const BodyPair& pair : geometry.pairs) rates.push_back(&pair.approach);
  refuse_unlimited_reach(robot, rates);
  geometry.matters = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (const Eigen::VectorXd* rate : rates)
    geometry.matters = geometry.matters.array().max((rate->array() > 0.0).cast<double>());
  return geometry;
}

}  // namespace

std::shared_ptr<const RobotGeometry> robot_geometry(const Robot& robot) {
  static LastMade<RobotGeometry> last;
  return last.get([&](const RobotGeometry& made) { return is_same(made.given, robot); },
                  [&] { return made_of(robot); });
}

}  // namespace clearway
