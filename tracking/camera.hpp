#pragma once

#include <Eigen/Core>
#include <optional>

#include "tracking/lens_distortion.hpp"

namespace clearway {

/// What a calibrated distortion leaves in an image's corner, pixels: one standard deviation.
constexpr double kKnownDistortion = 0.5;

/// What a calibration does not know of its camera: one standard deviation each.
struct CameraErrors {
  double focal = 0.003;              ///< relative, of fx and fy together
  double aspect = 0.0005;            ///< relative, of fx / fy
  double center = 2.0;               ///< pixels, of cx and of cy
  std::optional<double> distortion;  ///< pixels in the image's corner, of each mode of distortion; empty: 0.5
                                     ///< where a distortion is given, 1 % of half the diagonal where none is

  /// Throws std::invalid_argument naming the error that is negative or not finite.
  void validate() const;
};

/// Focal length, aspect, cx, cy, k1, k2, p1, p2.
constexpr int kCameraModes = 8;

/// A pinhole camera with Brown-Conrady ("plumb bob") or rational lens distortion, or a fisheye camera, as
/// OpenCV calibrates them.
///
/// Camera frame: x right, y down, z forward, metres. Pixels: the centre of the upper left pixel is
/// (0, 0), as everywhere in OpenCV; the image covers [-0.5, width - 0.5] x [-0.5, height - 0.5].
/// Normalised points are (x/z, y/z) of the ray in the camera frame, free of distortion.
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< pixels
  LensDistortion::Coefficients distortion{};      ///< as many as the lens's model has, the rest 0
  CameraErrors errors{};                          ///< of all of these
  LensDistortion::Model lens = LensDistortion::Model::plumb_bob;

  /// Throws std::invalid_argument naming the field and what was expected: `errors`, sizes in [32, 20000],
  /// focal lengths finite and > 0, principal point inside the image, finite distortion that maps the whole
  /// image one to one (a polynomial that folds back inside the image is a wrong calibration). Rational and
  /// fisheye lenses may see less than the image, but half of the way from the principal point to each side.
  void validate() const;

  /// The pixel at which a point of the camera frame is seen, possibly outside the image. Empty when the
  /// point is not in front of the camera (z <= 1e-9 m: what a fisheye sees at 90 degrees and more is not
  /// used), is not finite, or lies beyond the angle at which the distortion folds back (where the formula
  /// gives a pixel but the lens sees nothing).
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point) const;

  /// As `project`; also the derivative of the pixel by the point, pixels per metre.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point,
                                         Eigen::Matrix<double, 2, 3>& pixel_by_point) const;

  /// The normalised point seen at `pixel`, to 1e-12 (Newton). Empty where no ray of the lens ends there.
  std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& pixel) const;

  /// How far one standard deviation of each calibration error shifts the image at `pixel`, pixels. Distortion
  /// shifts by its size at the corner farthest from the middle, with the cube (k1, radial), the fifth power
  /// (k2) and the square (p1, p2, Brown 1966) of the distance from (cx, cy).
  Eigen::Matrix<double, 2, kCameraModes> shift_by_errors(const Eigen::Vector2d& pixel) const;

  /// True when the pixel lies on the image and at least `margin` pixels inside its border.
  bool sees(const Eigen::Vector2d& pixel, double margin = 0.0) const;
};

}  // namespace clearway
