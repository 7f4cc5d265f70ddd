#pragma once

#include <optional>
#include <vector>

#include "tracking/camera.hpp"
#include "tracking/uncertain_pose.hpp"

namespace clearway {

/// A point of a rigid body and the pixel it was seen at.
struct CornerMatch {
  Eigen::Vector3d in_body = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

struct RefinedPose {
  Eigen::Isometry3d camera_from_body = Eigen::Isometry3d::Identity();
  double squared_error = 0.0;               ///< sum over the corners of the squared distance, pixels^2
  Matrix6d information = Matrix6d::Zero();  ///< J^T J by UncertainPose's (v, w), for noise of 1 pixel
};

/// The local minimum of the squared reprojection error reached from `start` (Levenberg-Marquardt on the pose,
/// distortion included). Empty when there are fewer than three corners, a corner cannot be projected at the
/// start, or nothing finite is found. Deterministic; at most `max_steps` steps.
std::optional<RefinedPose> refine_pose(const Camera& camera, const std::vector<CornerMatch>& corners,
                                       const Eigen::Isometry3d& start, int max_steps = 50);

/// How far the body may be turned before its corners show it. For the two turns that the corners show least,
/// to both sides: the pose at which the squared error has risen by (sigmas * noise_px)^2, all but the turn
/// fitted anew; at least as far as the linear theory has it, at most `widest` radians farther than that. Four
/// poses, fewer where a corner leaves the camera's sight; none when the corners do not determine a pose.
std::vector<Eigen::Isometry3d> tilt_limits(const Camera& camera, const std::vector<CornerMatch>& corners,
                                           const Eigen::Isometry3d& best, double noise_px, double sigmas,
                                           double widest = 0.5);

}  // namespace clearway
