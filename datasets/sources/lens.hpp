#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// The name of a model in our files: "plumb_bob", "rational", "fisheye".
std::string lens_name(LensModel model);
/// The model of a name: ours, or ROS's and kalibr's radtan, rational_polynomial and equidistant.
std::optional<LensModel> lens_named(const std::string& name);
constexpr const char* known_lenses =
    "plumb_bob (radtan), rational (rational_polynomial) or fisheye (equidistant)";
/// How many coefficients a model has.
std::size_t coefficient_count(LensModel model);
/// Those of a camera, without the rest that is 0.
std::span<const double> coefficients_of(const CameraIntrinsics& camera);

/// Whether it bends rays: a fisheye does, even where all its coefficients are 0.
bool has_distortion(const CameraIntrinsics& camera);

/// Gives a camera its lens. A rational one whose last three are 0 is a plumb bob, and is called so.
/// @param coefficients of the model, or fewer: the rest is 0. What stands behind them must be 0, too.
/// @throws std::runtime_error with a clause of what was expected
void set_lens(CameraIntrinsics& camera, LensModel model, std::span<const double> coefficients);

/// A camera's lens, for many points and pixels. Rays are (x, y, 1) in the optical frame (x right, y down, z
/// forward): what a fisheye sees at 90 degrees and more from its axis has none.
class Lens {
 public:
  explicit Lens(const CameraIntrinsics& camera);

  /// Pixel of a point in the optical frame, z > 0, possibly outside the image. Empty beyond the lens's field;
  /// a plumb bob has none, its formula holds everywhere.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point) const;

  /// The ray (x, y, 1) of a pixel: the inverse of `project`, by Newton's method, exact to 1e-12. Empty beyond
  /// the lens's field. Where a plumb bob folds over (far outside the image) it is the best point found.
  std::optional<Eigen::Vector3d> pixel_ray(const Eigen::Vector2d& pixel) const;

  /// The angle to the axis, radians, up to which the model's radial part rises: the end of its field, at most
  /// 90 degrees.
  double widest() const { return widest_; }

 private:
  std::optional<Eigen::Vector3d> ray_of_plumb_bob(const Eigen::Vector2d& seen) const;
  std::optional<Eigen::Vector3d> ray_of_rational(const Eigen::Vector2d& seen) const;
  std::optional<Eigen::Vector3d> ray_of_fisheye(const Eigen::Vector2d& seen) const;
  double radial(double angle) const;

  CameraIntrinsics camera_;
  double widest_;
};

/// Where a depth camera's pixels look, row by row: right and down at a distance of 1 m along the optical
/// axis, by its lens. What lies beyond the lens's field, or where its formula folds over, is not finite.
std::vector<Eigen::Vector2d> depth_rays(const CameraIntrinsics& camera);

}  // namespace clearway
