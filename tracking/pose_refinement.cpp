#include "tracking/pose_refinement.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/dense.hpp"

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
    for (int i = 0; i < 2; ++i) by_motion.row(i).tail<3>() = corner.in_body.cross(by_motion.row(i).head<3>());
    const Eigen::Vector2d error = *pixel - corner.pixel;
    sum.squared_error += error.squaredNorm();
    for (int i = 0; i < 6; ++i) {  // the symmetric half; Eigen's product takes several times as long
      for (int k = 0; k <= i; ++k)
        sum.information(i, k) += by_motion(0, i) * by_motion(0, k) + by_motion(1, i) * by_motion(1, k);
      sum.gradient[i] += by_motion(0, i) * error[0] + by_motion(1, i) * error[1];
    }
  }
  sum.information.triangularView<Eigen::StrictlyUpper>() = sum.information.transpose();
  return sum;
}

struct Tilted {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double squared_error = 0.0;
};

// The best pose near `start` that is turned about `axis` (of the body) as `start` is: Gauss-Newton steps that
// a stiff spring keeps from turning about it.
std::optional<Tilted> fit_but_turn(const Camera& camera, const std::vector<CornerMatch>& corners,
                                   const Eigen::Isometry3d& start, const Eigen::Vector3d& axis) {
  constexpr int steps = 3;
  constexpr double stiffness = 1e6;
  Tilted best{start, 0.0};
  auto here = linearise(camera, corners, start);
  if (!here) return std::nullopt;
  best.squared_error = here->squared_error;
  for (int i = 0; i < steps; ++i) {
    Matrix6d information = here->information;
    const double most = information.bottomRightCorner<3, 3>().trace();
    information.bottomRightCorner<3, 3>() += stiffness * most * axis * axis.transpose();
    const Eigen::Isometry3d next = moved(best.pose, solve_symmetric(information, -here->gradient));
    here = linearise(camera, corners, next);
    if (!here || !(here->squared_error < best.squared_error)) break;
    best = {next, here->squared_error};
  }
  return best;
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
    const Vector6d motion = solve_symmetric(damped, -here->gradient);
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

std::vector<Eigen::Isometry3d> tilt_limits(const Camera& camera, const std::vector<CornerMatch>& corners,
                                           const Eigen::Isometry3d& best, double noise_px, double sigmas,
                                           double widest) {
  const auto here = linearise(camera, corners, best);
  if (!here) return {};
  const Cholesky information(here->information);
  if (!information.is_positive()) return {};
  const Matrix6d covariance = information.inverse();
  const Eigen::Matrix3d turns = covariance.bottomRightCorner<3, 3>();
  const auto [values, axes] = principal_axes(turns);
  const double allowed = here->squared_error + sigmas * sigmas * noise_px * noise_px;
  constexpr double growth = 1.25;
  constexpr int most_steps = 40;
  std::vector<Eigen::Isometry3d> limits;
  for (int i : {2, 1}) {
    const Eigen::Vector3d axis = axes.col(i);
    const double linear = sigmas * noise_px * std::sqrt(std::max(0.0, values[i]));
    for (double side : {1.0, -1.0}) {
      // Per radian about the axis, the motion that leaves the corners most nearly where they are.
      const Vector6d motion = product(covariance.rightCols<3>(), solve_symmetric(turns, side * axis));
      std::optional<Tilted> limit;
      double turn = linear;
      for (int step = 0; step < most_steps; ++step, turn = std::min(turn * growth, linear + widest)) {
        const auto tilted = fit_but_turn(camera, corners, moved(best, turn * motion), axis);
        if (!tilted) break;
        limit = tilted;
        if (tilted->squared_error >= allowed || turn >= linear + widest) break;
      }
      if (limit) limits.push_back(limit->pose);
    }
  }
  return limits;
}

}  // namespace clearway
