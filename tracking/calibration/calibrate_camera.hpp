#pragma once

#include <array>
#include <string>
#include <vector>

#include "tracking/calibration/bundle.hpp"
#include "tracking/calibration/focal_scatter.hpp"

namespace clearway {

struct CameraCalibrationOptions {
  double edge_bias = 0.1;             ///< see BodyPoseOptions
  std::size_t least_views = 8;        ///< that explain each other
  double most_focal_sigma = 0.005;    ///< relative; a camera that is known less well is refused
  double least_coverage = 0.5;        ///< share of the image in which the board must be seen
  double most_sag = 0.02;             ///< of a bent board over its width
  double most_focal_scatter = 0.002;  ///< relative, of the focal length from view to view
  int folds = 5;                      ///< of the test on views that were held out
  LensDistortion::Model lens = LensDistortion::Model::plumb_bob;
};

/// A view that was not used.
struct RefusedView {
  std::string name, reason;  ///< one clause
};

/// What another lens explains of the same views.
struct OtherLens {
  LensDistortion::Model lens;
  double held_out_px;  ///< as that of the calibration; infinity where it does not see or explain all views
};

struct CameraCalibration {
  Camera camera;               ///< with what is not known of it
  std::string refusal;         ///< one sentence why it is not to be used; empty: it is good
  Eigen::MatrixXd covariance;  ///< of the kSharedUnknowns
  double noise_px = 0.0;       ///< of a corner per axis
  double rms_px = 0.0;         ///< of the views that were used
  double held_out_px = 0.0;    ///< rms of views that the calibration has not seen, their poses fitted
  double held_out_mm = 0.0;    ///< the same at the board
  double coverage = 0.0;       ///< share of the image inside the hull of the board's corners in some view
  double widest_tilt = 0.0;    ///< radians between board and image plane, which one in ten views exceeds
  double widest_roll = 0.0;    ///< radians about the line of sight, between two views: a quarter turn at most
  double stretch = 0.0;        ///< of the board's print along one side, relative
  std::array<double, 4> corner_errors{};  ///< see corner_errors
  double sag = 0.0;                       ///< metres by which the board is bent out of its plane
  double width = 0.0;                     ///< metres, of the circle around the board's tags
  FocalScatter focal_scatter;             ///< `covariance` counts it, errors.focal where it is likely
  std::size_t views = 0;                  ///< used
  std::vector<RefusedView> refused;
  std::vector<OtherLens> simpler;  ///< of a rational lens: plumb_bob and fisheye
};

/// Camera from views of a board whose tags lie in one plane. OpenCV's calibrateCamera (Zhang 2000) begins;
/// bundle adjustment of camera, poses and the board, held by the board's own stated errors, ends, so that
/// the covariance counts these too; corners were found where straight lines along their edges meet
/// (corners_by_straight_edges); how far blur moves the edges of all tags alike is one more unknown,
/// but of rational lenses; how far the print is stretched along one side another, which views of a board that
/// is never turned on its side hardly tell from the camera's aspect. k3 stays 0 unless the views show it by
/// four standard deviations; the covariance counts what it may be. Views and tags that contradict the others
/// are left out: at most a third. The errors of the camera are as large as the covariance moves the image,
/// in its corners, too; distortion takes what the others do not explain. A camera whose corners are known
/// worse than to 1 % of half the diagonal is refused, but of a fisheye, which may not see them. The errors of
/// views held out are found by `folds` further calibrations.
///
/// A fisheye begins as the equidistant one (k1 to k4 all 0, the principal point in the middle) whose focal
/// length, of those that show 35 to 125 degrees in the corners, explains the views best, each with a pose of
/// its own. All of k1 to k4 are free.
///
/// A rational lens begins as a plumb bob or as such a fisheye. All of k1 to k6 are free. It is refused unless
/// k4, k5 and k6 differ from 0 (Wald's test, once in 10,000), and a plumb bob is off by 1 % more on held-out
/// views.
/// @throws std::invalid_argument when the board is not flat, the size is no image's
CameraCalibration calibrate_camera(int width, int height, const TagBody& board, std::vector<BoardView> views,
                                   const CameraCalibrationOptions& options = {});

}  // namespace clearway
