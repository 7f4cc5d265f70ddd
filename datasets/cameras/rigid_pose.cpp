#include "datasets/cameras/rigid_pose.hpp"

namespace clearway {

std::optional<Eigen::Isometry3d> rigid_pose(const Eigen::Matrix4d& matrix) {
  constexpr double most_off = 1e-3, most_off_below = 1e-6;
  const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
  const Eigen::RowVector4d below = matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1);
  if (!matrix.allFinite() || below.cwiseAbs().maxCoeff() > most_off_below ||
      !(turn * turn.transpose()).isIdentity(most_off) || turn.determinant() < 0.0)
    return std::nullopt;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(turn).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

Eigen::Isometry3d optical_from_sensor() {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return result;
}

}  // namespace clearway
