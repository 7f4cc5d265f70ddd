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

std::vector<Configuration> finely(const Configuration& from, const Configuration& to, double step) {
  const Eigen::VectorXd dq = to - from;
  const int pieces = std::max(1, static_cast<int>(std::ceil(dq.cwiseAbs().maxCoeff() / step)));
  std::vector<Configuration> fine;
  for (int k = 0; k <= pieces; ++k) fine.push_back(from + static_cast<double>(k) / pieces * dq);
  return fine;
}

}  // namespace clearway
