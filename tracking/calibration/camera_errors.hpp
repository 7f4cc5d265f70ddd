#pragma once

#include <Eigen/Core>
#include <array>

#include "tracking/camera.hpp"

namespace clearway {

/// Errors of a camera that move each part of the image as the covariance does, or more. Errors of focal
/// length, aspect and centre are their own ones; distortion takes what these do not explain, up to the
/// corners.
/// @param covariance of the kSharedUnknowns
CameraErrors errors_of(const Camera& camera, const Eigen::MatrixXd& covariance);

/// How far the image's corners may be moved, pixels, one standard deviation: upper left, upper right, lower
/// right, lower left. 0 where the lens sees nothing.
std::array<double, 4> corner_errors(const Camera& camera, const Eigen::MatrixXd& covariance);

}  // namespace clearway
