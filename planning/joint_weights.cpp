#include "planning/joint_weights.hpp"

#include <algorithm>

namespace clearway {

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
  const double chosen = prismatic_scale > 0.0 ? prismatic_scale : longest > 0.0 ? 1.0 / longest : 1.0;
  for (Eigen::Index j = 0; j < reach.size(); ++j) {
    if (robot.joints[static_cast<std::size_t>(j)].kind == JointKind::prismatic) weights[j] = chosen;
  }
  return weights;
}

}  // namespace clearway
