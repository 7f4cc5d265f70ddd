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

/// What was seen in the looks, as stated: how errors of the tags move the poses follows from it.
struct PivotRig {
  Camera camera;
  TagBody probe;
  TagBody base{};  ///< of the looks that have one
};

struct PivotOptions {
  std::size_t least_looks = 15;
  double least_turn = 0.5;    ///< radians, between the two looks that differ most
  double most_sigma = 0.001;  ///< metres, of the ball's centre in the worst direction
};

struct PivotCalibration {
  std::string refusal;                                   ///< one sentence; empty: it is good
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();        ///< in the probe, metres
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of `ball`, m^2: the sum of its parts
  /// By what looks do not share, by the camera, by tags of probe and base.
  struct Parts {
    Eigen::Matrix3d noise = Eigen::Matrix3d::Zero(), camera = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d probe = Eigen::Matrix3d::Zero(), base = Eigen::Matrix3d::Zero();
  } parts;
  double rms = 0.0;   ///< of the ball's places about their common one, metres
  double turn = 0.0;  ///< radians, between the two looks that differ most
  std::size_t looks = 0, left_out = 0;
};

/// The point of the probe that stays in its place: least squares of R b + t = p over all looks, each weighed
/// by the noise of its pose, and by how far the ball slips in its cup: what the residuals show beyond the
/// errors that are stated. Looks that contradict the others are left out, a third at most. The covariance
/// also counts errors that all looks share, with their signs: those of the camera and of each tag. So errors
/// of the base's tags, seen from one side, move the place of the ball and not the ball in the probe. Where
/// the ball is not known well enough, the refusal names the largest part and its cure.
PivotCalibration calibrate_pivot(const std::vector<PivotLook>& looks, const PivotRig& rig,
                                 const PivotOptions& options = {});

}  // namespace clearway
