#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tracking/tag_body.hpp"

namespace clearway {

/// One image of a probe that turns about its ball, which stands still.
struct PivotLook {
  BodyPose probe;
  std::optional<BodyPose> base;  ///< the body against which the ball stands still; empty: the camera does
};

struct PivotOptions {
  std::size_t least_looks = 15;
  double least_turn = 0.5;    ///< radians, between the two looks that differ most
  double most_sigma = 0.001;  ///< metres, of the ball's centre in the worst direction
};

struct PivotCalibration {
  std::string refusal;                                   ///< one sentence; empty: it is good
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();        ///< in the probe, metres
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of `ball`, m^2: noise, camera and tags
  double rms = 0.0;   ///< of the ball's places about their common one, metres
  double turn = 0.0;  ///< radians, between the two looks that differ most
  std::size_t looks = 0, left_out = 0;
};

/// The point of the probe that stays in its place: least squares of R b + t = p over all looks, each weighed
/// by the covariance of its pose, which is enlarged to what the residuals show. Looks that contradict the
/// others are left out, a third at most. The covariance also counts errors that all looks share: those of the
/// camera with their signs, those of tags as one look has them.
PivotCalibration calibrate_pivot(const std::vector<PivotLook>& looks, const PivotOptions& options = {});

}  // namespace clearway
