#include "tracking/calibration/camera_errors.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/calibration/bundle.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace {

/// Square pixels by which the image moves where it shows a ray.
double square_motion(const Camera& camera, const Eigen::Vector2d& ray, const Eigen::MatrixXd& covariance) {
  return sandwich(pixel_by_camera(camera, ray.homogeneous()), covariance).trace();
}

}  // namespace

CameraErrors errors_of(const Camera& camera, const Eigen::MatrixXd& covariance) {
  CameraErrors errors;
  errors.focal = std::sqrt(covariance(0, 0));
  errors.aspect = std::sqrt(covariance(1, 1));
  errors.center = std::sqrt(std::max(covariance(2, 2), covariance(3, 3)));
  // Distortion: its covariance alone, what centre and focal length explain of it taken away (Schur).
  const Eigen::MatrixXd own = covariance.block(4, 4, kLensUnknowns, kLensUnknowns);
  const Eigen::MatrixXd cross = covariance.block(4, 0, kLensUnknowns, 4);
  const Eigen::MatrixXd known = solve_symmetric(covariance.topLeftCorner(4, 4), cross.transpose());
  const Eigen::MatrixXd left = own - product(cross, known);
  Camera unit = camera, others = camera;
  unit.errors = {0.0, 0.0, 0.0, 1.0};
  others.errors = {errors.focal, errors.aspect, errors.center, 0.0};
  constexpr double outer = 0.1;  // square pixels of `unit`: further in, the other errors explain the image
  double most = 0.0;
  const double f = std::sqrt(camera.fx * camera.fy);
  for (int i = 0; i <= 12; ++i)
    for (int j = 0; j <= 12; ++j) {
      const Eigen::Vector2d pixel(camera.width * i / 12.0 - 0.5, camera.height * j / 12.0 - 0.5);
      const auto ray = camera.undistort(pixel);
      if (!ray || ray->norm() < 1e-3) continue;
      const double by_unit = unit.shift_by_errors(pixel).squaredNorm();
      const double alone = f * f * sandwich(seen_by_coefficients(camera, *ray), left).trace();
      if (by_unit > 1e-4) most = std::max(most, alone / by_unit);
      // Where the board was not seen, errors that cancel each other elsewhere add up.
      const double beyond =
          square_motion(camera, *ray, covariance) - others.shift_by_errors(pixel).squaredNorm();
      if (by_unit > outer) most = std::max(most, beyond / by_unit);
    }
  errors.distortion = std::sqrt(most);
  return errors;
}

std::array<double, 4> corner_errors(const Camera& camera, const Eigen::MatrixXd& covariance) {
  const double right = camera.width - 0.5, low = camera.height - 0.5;
  const std::array<Eigen::Vector2d, 4> corners{
      Eigen::Vector2d(-0.5, -0.5), {right, -0.5}, {right, low}, {-0.5, low}};
  std::array<double, 4> errors{};
  for (std::size_t i = 0; i < 4; ++i)
    if (const auto ray = camera.undistort(corners[i]))
      errors[i] = std::sqrt(square_motion(camera, *ray, covariance));
  return errors;
}

}  // namespace clearway
