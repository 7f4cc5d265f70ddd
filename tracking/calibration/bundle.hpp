#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "tracking/calibration/board_bend.hpp"
#include "tracking/camera.hpp"
#include "tracking/tag_body.hpp"

namespace clearway {

/// One image of a board.
struct BoardView {
  std::string name;                ///< what a report calls it
  std::vector<TagDetection> tags;  ///< of the board, each id once
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
};

/// log f (fx and fy together), log(fx / fy), cx, cy, then the coefficients of the lens in OpenCV's order;
/// pixels where a length. Coefficients that a model does not have are known exactly: 0. Then, how far the
/// edges of all tags are seen outside of where they are, as blur and a bent grey scale shift them: pixels,
/// and pixels times the tag's side in pixels, for small tags are shifted more. Last, the board's curvatures,
/// and how its print is stretched.
constexpr int kSharedUnknowns = 18;
constexpr int kLensUnknowns = 8;  ///< from the fifth on
constexpr int kFirstOfGrowth = 4 + kLensUnknowns;
constexpr int kFirstOfBend = kFirstOfGrowth + 2;
constexpr int kStretchUnknown = kFirstOfBend + kBendUnknowns;
/// Of each tag: log size, place in the board (metres), turn about the tag's axes (radians).
constexpr int kTagUnknowns = 7;

/// How well camera and board are known before: standard deviations; 0: exactly; infinity: not at all.
struct BundlePriors {
  std::array<double, kSharedUnknowns> shared{};
  std::vector<std::array<double, kTagUnknowns>> tags;  ///< in the order of TagBody::tags
};

/// Camera, board and views that explain each other.
struct Bundle {
  Camera camera;
  TagBody board;  ///< as if it were flat
  std::vector<BoardView> views;
  BoardBend bend{};
};

/// The corners of a tag of the board where the bend has them, in the board's frame.
std::array<Eigen::Vector3d, 4> corners_on_board(const MountedTag& tag, const BoardBend& bend);

/// How the corners of a tag move when all its edges move out by a pixel, in the image.
std::array<Eigen::Vector2d, 4> outward(const std::array<Eigen::Vector2d, 4>& corners);

/// How many tags views show.
std::size_t tags_of(const std::vector<BoardView>& views);

struct BundleFit {
  bool is_converged = false;
  double noise_px = 0.0;       ///< standard deviation of a corner per axis, as the residuals show it
  double rms_px = 0.0;         ///< root mean square distance of the corners
  double chi_square = 0.0;     ///< whitened squares of residuals and priors, for the noise that was given
  int freedom = 0;             ///< corner coordinates and priors, less unknowns
  Eigen::MatrixXd covariance;  ///< of the camera's unknowns, then each tag's; 0 for what is known exactly
  std::vector<std::vector<double>> tag_squares;  ///< whitened squares of each tag of each view; 8 expected
  /// The logarithm of each view's own focal length over the common one, to first order, its pose free, and
  /// the standard deviation of that: infinity where the view does not tell.
  struct FocalStep {
    double off = 0.0, sigma = std::numeric_limits<double>::infinity();
  };
  std::vector<FocalStep> focal_steps;
  /// How the unknowns (rows, as in `covariance`) follow each view's own focal length (columns).
  Eigen::MatrixXd by_own_focal;
};

/// The derivative of a distorted normalised point by the coefficients of the lens; 0 by those that its model
/// does not have. @param ray (x/z, y/z), in sight
Eigen::Matrix<double, 2, kLensUnknowns> seen_by_coefficients(const Camera& camera,
                                                             const Eigen::Vector2d& ray);

/// The derivative of a pixel by the camera's unknowns; 0 by the others that are shared. @param point in the
/// camera, in sight
Eigen::MatrixXd pixel_by_camera(const Camera& camera, const Eigen::Vector3d& point);

/// Standard deviations of a known camera's unknowns by its `errors`; k3 to k6 of a plumb bob or rational lens
/// are taken as exact.
std::array<double, kSharedUnknowns> camera_priors(const Camera& camera);

/// Bundle adjustment (Triggs et al. 2000, section 6: the views' poses are eliminated): Levenberg-Marquardt
/// over all poses, and over camera, bend and tags about where they are given, held by `priors`. A corner's
/// noise is `noise_px` per axis; `edge_bias` shifts whole edges of a tag (see view_tag). Deterministic.
/// @pre each view shows tags of the board alone, and its pose sees their corners
BundleFit adjust(Bundle& bundle, const BundlePriors& priors, double noise_px, double edge_bias);

/// The same, the noise estimated from the residuals: so that chi_square is what `freedom` makes expect.
BundleFit adjust_with_noise(Bundle& bundle, const BundlePriors& priors, double edge_bias);

}  // namespace clearway
