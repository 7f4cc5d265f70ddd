#include "planning/space/joint_weights.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double least_automatic_scale = 1e-4;  ///< rad per metre: of a robot that reaches 10 km

/// Beside such limits a metre would count next to nothing. Without any limit (a reach without bound) planners
/// have their own answers.
void refuse_absurd_limits(const Robot& robot, double reach) {
  if (!std::isfinite(reach) || reach * least_automatic_scale <= 1.0) return;
  const Joint* widest = nullptr;
  for (const Joint& joint : robot.joints) {
    if (joint.kind != JointKind::prismatic) continue;
    if (!widest || joint.upper - joint.lower > widest->upper - widest->lower) widest = &joint;
  }
  if (!widest) return;
  throw std::invalid_argument("joint " + quote(widest->name) + " slides from " + short_text(widest->lower) +
                              " to " + short_text(widest->upper) + " m and the robot reaches " +
                              short_text(reach) +
                              " m, too far to derive how many radians a metre counts: expected option "
                              "'prismatic_scale' (rad per metre), or narrower joint limits");
}

}  // namespace

Eigen::VectorXd joint_reach(const ConfigurationSpace& space) {
  const auto n = static_cast<Eigen::Index>(space.robot().dof());
  return Eigen::VectorXd::NullaryExpr(
      n, [&](Eigen::Index j) { return space.motion_bound(Eigen::VectorXd::Unit(n, j)); });
}

Eigen::VectorXd joint_weights(const ConfigurationSpace& space, double prismatic_scale) {
  const Robot& robot = space.robot();
  const Eigen::VectorXd reach = joint_reach(space);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(reach.size());
  double longest = 0.0;
  for (Eigen::Index j = 0; j < reach.size(); ++j) {
    if (robot.joints[static_cast<std::size_t>(j)].kind == JointKind::revolute)
      longest = std::max(longest, reach[j]);
  }
  if (prismatic_scale <= 0.0) refuse_absurd_limits(robot, longest);
  const double chosen = prismatic_scale > 0.0 ? prismatic_scale : longest > 0.0 ? 1.0 / longest : 1.0;
  for (Eigen::Index j = 0; j < reach.size(); ++j) {
    if (robot.joints[static_cast<std::size_t>(j)].kind == JointKind::prismatic) weights[j] = chosen;
  }
  return weights;
}

}  // namespace clearway
