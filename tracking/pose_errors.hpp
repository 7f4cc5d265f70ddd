#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tracking/camera.hpp"
#include "tracking/uncertain_pose.hpp"

namespace clearway {

/// How far a body may be from what its setup says: one standard deviation each.
struct TagErrors {
  double scale = 0.002;   ///< relative, of all sizes and places together: the printer, the ruler
  double size = 0.003;    ///< relative, of each tag on its own
  double place = 0.0005;  ///< metres along each axis, of each tag
  double turn = 0.005;    ///< radians about each axis, of each tag: glue, bent paper

  /// Throws std::invalid_argument naming the body and the error that is negative or not finite.
  void validate(const std::string& body) const;
};

/// The corners of one tag in one image and all that moves them, to first order about a pose of its body. Rows
/// are x and y of the four corners, pixels; error columns are scaled to one standard deviation.
struct TagView {
  Eigen::Matrix<double, 8, 1> residual;                  ///< predicted minus seen
  Eigen::Matrix<double, 8, 6> by_motion;                 ///< per metre and radian of UncertainPose's (v, w)
  Eigen::Matrix<double, 8, kCameraModes + 1> by_shared;  ///< camera, then the body's scale
  Eigen::Matrix<double, 8, 11> by_own;                   ///< size, place, turn, then the four edges' bias
};

/// Linearises a tag of side `size` at `body_from_tag` whose corners were `seen`. `edge_bias` is the standard
/// deviation by which the detector may shift each edge of the square along its normal, pixels. Empty when a
/// corner cannot be projected.
std::optional<TagView> view_tag(const Camera& camera, double size, const Eigen::Isometry3d& body_from_tag,
                                const TagErrors& errors, double edge_bias,
                                const std::array<Eigen::Vector2d, 4>& seen,
                                const Eigen::Isometry3d& camera_from_body);

/// The squared residuals that are left when all stated errors have explained what they can: the minimum over
/// the errors e of |residual + D e|^2 / noise^2 + |e|^2, the pose fixed. Chi-square when the errors are what
/// was stated.
double unexplained(const std::vector<TagView>& tags, double noise_px);

/// What each source of error makes of a least-squares pose, in UncertainPose's (v, w).
struct PoseErrors {
  Eigen::Matrix<double, 6, kCameraModes> by_camera =
      Eigen::Matrix<double, 6, kCameraModes>::Zero();  ///< motion per standard deviation, with its sign: two
                                                       ///< bodies in one image share these errors
  Matrix6d noise = Matrix6d::Zero();                   ///< covariance by corners' independent noise
  Matrix6d tags = Matrix6d::Zero();   ///< by sizes, places and turns of tags and their common scale
  Matrix6d edges = Matrix6d::Zero();  ///< by the detector's bias
};

/// Empty when the tags do not determine a pose.
std::optional<PoseErrors> carry_errors(const std::vector<TagView>& tags, double noise_px);

/// The value that a chi-square variable of so many degrees of freedom exceeds once in 10,000 times (Wilson
/// and Hilferty 1931).
double chi_square_limit(int freedom);

/// How many standard deviations from the truth a point of space keeps within in 99.9 % of cases, when the
/// noise is estimated with so many degrees of freedom: the square root of 3 F(3, freedom), Hotelling's T for
/// three dimensions. At least 10 of them.
double confidence_factor(int freedom);

}  // namespace clearway
