#include "apps/suites/suite_hand.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace clearway {

SuiteHand::SuiteHand(const Robot& robot, const std::string& kind) : robot_(robot) {
  const std::set<std::string> critical(robot.critical_parts.begin(), robot.critical_parts.end());
  for (const Body& body : robot.bodies) {
    if (critical.empty() ? body.link == robot.tip_link : critical.count(body.part) > 0)
      bodies_.push_back(&body);
  }
  if (bodies_.empty()) {
    throw std::runtime_error(kind + ": robot '" + robot.name +
                             "' has no critical part and no body at its tip");
  }
}

Sphere SuiteHand::sphere(const Configuration& q) const {
  const LinkPoses poses = forward_kinematics(robot_, q);
  Eigen::AlignedBox3d box;
  for (const Body* body : bodies_) box.extend(center(*body, poses));
  Sphere sphere{box.center(), 0.0};
  for (const Body* body : bodies_) {
    const double off = (center(*body, poses) - sphere.center).norm();
    sphere.radius = std::max(sphere.radius, off + body->shape.bounding_radius());
  }
  return sphere;
}

Eigen::Vector3d SuiteHand::center(const Body& body, const LinkPoses& poses) {
  return poses[static_cast<std::size_t>(body.link)] * body.link_from_shape.translation();
}

namespace {

/// The axis of the last joint, in the tip's frame; zero: it is none that turns, or the tip is beside it.
Eigen::Vector3d axis_before_tip(const Robot& robot) {
  Eigen::Isometry3d link_from_tip = robot.link_from_tip;
  int link = robot.tip_link;
  while (link > 0 && robot.links[static_cast<std::size_t>(link)].joint < 0) {
    const Link& at = robot.links[static_cast<std::size_t>(link)];
    link_from_tip = at.parent_from_link * link_from_tip;
    link = at.parent;
  }
  const Link& moved = robot.links[static_cast<std::size_t>(link)];
  if (link <= 0) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d axis = axis_of(robot, moved);
  const double along = axis.dot(link_from_tip.translation());
  const bool is_beside = (link_from_tip.translation() - along * axis).norm() > 0.5 * std::abs(along);
  if (kind_of(robot, moved) == JointKind::prismatic || along == 0.0 || is_beside)
    return Eigen::Vector3d::Zero();
  return link_from_tip.linear().transpose() * (along > 0.0 ? axis : Eigen::Vector3d(-axis));
}

}  // namespace

HandAtTip hand_at_tip(const Robot& robot) {
  constexpr double widest = 0.7071;  // cosine
  HandAtTip hand;
  const Eigen::Vector3d ahead = axis_before_tip(robot);
  if (!ahead.isZero() && ahead.z() < widest) hand.axis = ahead;
  for (const Body& body : robot.bodies) {
    Eigen::Isometry3d tip_link_from_body = body.link_from_shape;
    int link = body.link;
    while (link > robot.tip_link && robot.links[static_cast<std::size_t>(link)].joint < 0) {
      tip_link_from_body = robot.links[static_cast<std::size_t>(link)].parent_from_link * tip_link_from_body;
      link = robot.links[static_cast<std::size_t>(link)].parent;
    }
    if (link != robot.tip_link) continue;
    const Eigen::Isometry3d in_tip = robot.link_from_tip.inverse() * tip_link_from_body;
    const Eigen::Vector3d farthest = in_tip * body.shape.support(in_tip.linear().transpose() * hand.axis);
    hand.depth = std::max(hand.depth, hand.axis.dot(farthest));
  }
  return hand;
}

std::vector<Configuration> finely(const Configuration& from, const Configuration& to, double step) {
  const Eigen::VectorXd dq = to - from;
  const int pieces = std::max(1, static_cast<int>(std::ceil(dq.cwiseAbs().maxCoeff() / step)));
  std::vector<Configuration> fine;
  for (int k = 0; k <= pieces; ++k) fine.push_back(from + static_cast<double>(k) / pieces * dq);
  return fine;
}

}  // namespace clearway
