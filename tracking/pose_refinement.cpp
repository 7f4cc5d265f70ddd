#include "tracking/pose_refinement.hpp"

#include <Eigen/Cholesky>

namespace clearway {
namespace {

struct NormalEquations {
  double squared_error = 0.0;
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

std::optional<NormalEquations> linearise(const Camera& camera, const std::vector<CornerMatch>& corners,
                                         const Eigen::Isometry3d& camera_from_body) {
  NormalEquations sum;
  for (const CornerMatch& corner : corners) {
    Eigen::Matrix<double, 2, 3> pixel_by_point;
    const auto pixel = camera.project(camera_from_body * corner.in_body, pixel_by_point);
    if (!pixel) return std::nullopt;
    Eigen::Matrix<double, 2, 6> by_motion;
    by_motion.leftCols<3>() = pixel_by_point * camera_from_body.linear();
    by_motion.rightCols<3>() = -by_motion.leftCols<3>() * cross_matrix(corner.in_body);
    const Eigen::Vector2d error = *pixel - corner.pixel;
    sum.squared_error += error.squaredNorm();
    sum.information += by_motion.transpose() * by_motion;
    sum.gradient += by_motion.transpose() * error;
  }
  return sum;
}

}  // namespace

std::optional<RefinedPose> refine_pose(const Camera& camera, const std::vector<CornerMatch>& corners,
                                       const Eigen::Isometry3d& start, int max_steps) {
  if (corners.size() < 3) return std::nullopt;
  Eigen::Isometry3d pose = start;
  auto here = linearise(camera, corners, pose);
  if (!here) return std::nullopt;
  double damping = 1e-4;
  for (int step = 0; step < max_steps && damping < 1e12; ++step) {
    Matrix6d damped = here->information;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d motion = damped.ldlt().solve(-here->gradient);
    if (!motion.allFinite()) return std::nullopt;
    const Eigen::Isometry3d next = moved(pose, motion);
    const auto there = linearise(camera, corners, next);
    if (!there || !(there->squared_error <= here->squared_error)) {
      damping *= 10.0;
      continue;
    }
    pose = next;
    here = there;
    damping = std::max(1e-12, 0.1 * damping);
    if (motion.norm() < 1e-9) break;
  }
  const Eigen::Quaterniond unit = Eigen::Quaterniond(pose.linear()).normalized();
  pose.linear() = unit.toRotationMatrix();
  return RefinedPose{pose, here->squared_error, here->information};
}

}  // namespace clearway
