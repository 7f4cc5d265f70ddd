#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace clearway {

/// How a lens bends rays: OpenCV's models of normalised points.
class LensDistortion {
 public:
  enum class Model {
    plumb_bob,  ///< k1, k2, p1, p2, k3 (Brown-Conrady)
    rational,   ///< k1, k2, p1, p2, k3, k4, k5, k6 (OpenCV's CALIB_RATIONAL_MODEL)
    fisheye     ///< k1, k2, k3, k4 of the angle to the axis (Kannala and Brandt 2006; cv::fisheye)
  };
  using Coefficients = std::array<double, 8>;  ///< in OpenCV's order, the rest 0

  /// @param coefficients finite
  explicit LensDistortion(const Coefficients& coefficients, Model model = Model::plumb_bob);

  /// The distorted point, and its derivative by `ray` = (x/z, y/z). Empty beyond the angle at which the
  /// model folds back, where the formula gives a point but the lens sees nothing.
  std::optional<Eigen::Vector2d> distort(const Eigen::Vector2d& ray, Eigen::Matrix2d& by_ray) const;

  /// The ray (x/z, y/z) that is distorted to `seen`, to 1e-12 (Newton). Empty where no ray ends there: beyond
  /// the fold, and for a fisheye 90 degrees and more from the axis, where a ray has no (x/z, y/z).
  std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& seen) const;

  bool is_none() const { return is_none_; }  ///< a pinhole: no fisheye, all coefficients are zero
  /// The square of the radius at which the radial part stops growing; infinity when it never does, for a
  /// fisheye not within 90 degrees.
  double fold_squared() const;

 private:
  bool rises_to(double squared) const;  ///< the radial part, from the axis to a ray of that squared radius
  Eigen::Vector2d bend(const Eigen::Vector2d& ray, Eigen::Matrix2d& by_ray) const;
  Eigen::Vector2d bend_angle(const Eigen::Vector2d& ray, Eigen::Matrix2d& by_ray) const;
  std::optional<Eigen::Vector2d> undistort_polynomial(const Eigen::Vector2d& seen) const;
  std::optional<Eigen::Vector2d> undistort_rational(const Eigen::Vector2d& seen) const;
  std::optional<Eigen::Vector2d> undistort_angle(const Eigen::Vector2d& seen) const;

  Coefficients coefficients_;
  Model model_;
  bool is_none_;
  std::array<double, 7> slope_{};    ///< > 0 where the radial part rises, in r^2 or angle^2; not of plumb_bob
  std::array<double, 4> divisor_{};  ///< of rational: its denominator, in r^2
};

}  // namespace clearway
