#pragma once

#include <Eigen/Core>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// Pixel of a point in the optical frame (x right, y down, z forward, z > 0), lens distortion included.
Eigen::Vector2d project(const CameraIntrinsics& camera, const Eigen::Vector3d& point);

/// The ray (x, y, 1) of a pixel in the optical frame: the inverse of `project`, by Newton's method, exact to
/// 1e-12. Where the lens model folds over (far outside the image) it returns the best point found.
Eigen::Vector3d pixel_ray(const CameraIntrinsics& camera, const Eigen::Vector2d& pixel);

}  // namespace clearway
