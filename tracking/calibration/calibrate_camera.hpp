#pragma once

#include <string>
#include <vector>

#include "tracking/calibration/bundle.hpp"

namespace clearway {

struct CameraCalibrationOptions {
  double edge_bias = 0.1;           ///< see BodyPoseOptions
  std::size_t least_views = 8;      ///< that explain each other
  double most_focal_sigma = 0.005;  ///< relative; a camera that is known less well is refused
  double least_coverage = 0.5;      ///< share of the image's 4 x 4 cells that must show a corner
  int folds = 5;                    ///< of the test on views that were held out
  /// plumb_bob or fisheye. k1 to k6 of a rational lens trade against each other too freely to be held.
  LensDistortion::Model lens = LensDistortion::Model::plumb_bob;
};

/// A view that was not used.
struct RefusedView {
  std::string name, reason;  ///< one clause
};

struct CameraCalibration {
  Camera camera;               ///< with what is not known of it
  std::string refusal;         ///< one sentence why it is not to be used; empty: it is good
  Eigen::MatrixXd covariance;  ///< of the kCameraUnknowns
  double noise_px = 0.0;       ///< of a corner per axis
  double rms_px = 0.0;         ///< of the views that were used
  double held_out_px = 0.0;    ///< rms of views that the calibration has not seen, their poses fitted
  double held_out_mm = 0.0;    ///< the same at the board
  double coverage = 0.0;       ///< share of the image's 4 x 4 cells with a corner
  double widest_tilt = 0.0;    ///< radians between board and image plane, which one in ten views exceeds
  std::size_t views = 0;       ///< used
  std::vector<RefusedView> refused;
};

/// Camera from views of a board whose tags lie in one plane. OpenCV's calibrateCamera (Zhang 2000) begins;
/// bundle adjustment of camera, poses and the board, held by the board's own stated errors, ends, so that
/// the covariance counts these too. k3 stays 0 unless the views show it by four standard deviations. Views
/// and tags that contradict the others are left out: at most a third. The errors of the camera are as large
/// as the covariance moves the image wherever it was covered; distortion takes what the others do not
/// explain. The errors of views held out are found by `folds` further calibrations.
///
/// A fisheye begins as the equidistant one (k1 to k4 all 0, the principal point in the middle) whose focal
/// length, of those that show 35 to 125 degrees in the corners, explains the views best, each with a pose of
/// its own. All of k1 to k4 are free.
/// @throws std::invalid_argument when the board is not flat, the size is no image's or the lens is rational
CameraCalibration calibrate_camera(int width, int height, const TagBody& board, std::vector<BoardView> views,
                                   const CameraCalibrationOptions& options = {});

}  // namespace clearway
