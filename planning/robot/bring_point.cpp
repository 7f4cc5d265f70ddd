#include "planning/robot/bring_point.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace clearway {
namespace {

Eigen::VectorXd least_change(const Eigen::Matrix3Xd& j, const Eigen::Vector3d& error) {
  Eigen::Matrix3d normal = j * j.transpose();
  normal.diagonal().array() += 1e-4 * normal.trace() + 1e-12;
  return j.transpose() * normal.ldlt().solve(error);
}

}  // namespace

bool bring_point(const Robot& robot, const PointTarget& wanted, int most_steps, Configuration& q,
                 LinkPoses& poses) {
  for (int i = 0; i < most_steps; ++i) {
    forward_kinematics(robot, q, poses);
    const Eigen::Vector3d at = poses[static_cast<std::size_t>(wanted.link)] * wanted.point;
    const Eigen::Vector3d error = wanted.target - at;
    if (error.norm() <= wanted.tolerance) return true;
    Eigen::Matrix3Xd j = jacobian(robot, poses, wanted.link, at).topRows<3>();
    Eigen::VectorXd change = least_change(j, error);
    bool is_limited = false;
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
      if (q[k] + change[k] >= joint.lower && q[k] + change[k] <= joint.upper) continue;
      j.col(k).setZero();
      is_limited = true;
    }
    if (is_limited) change = least_change(j, error);
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
      q[k] = std::clamp(q[k] + change[k], joint.lower, joint.upper);
    }
  }
  return false;
}

}  // namespace clearway
