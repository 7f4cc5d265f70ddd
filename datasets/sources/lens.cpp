#include "datasets/sources/lens.hpp"

#include <Eigen/LU>
#include <cmath>

namespace clearway {
namespace {

/// Plumb bob: a point of the ideal image plane z = 1 moved by the lens, and the derivative of that.
Eigen::Vector2d distort(const std::array<double, 5>& d, const Eigen::Vector2d& ideal,
                        Eigen::Matrix2d* derivative) {
  const double x = ideal.x(), y = ideal.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  if (derivative) {
    const double slope = d[0] + r2 * (2 * d[1] + r2 * 3 * d[4]);  // d radial / d r2
    const double mixed = 2 * x * y * slope + 2 * d[2] * x + 2 * d[3] * y;
    *derivative << radial + 2 * x * x * slope + 2 * d[2] * y + 6 * d[3] * x, mixed, mixed,
        radial + 2 * y * y * slope + 6 * d[2] * y + 2 * d[3] * x;
  }
  return {x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x),
          y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y};
}

}  // namespace

Eigen::Vector2d project(const CameraIntrinsics& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector2d seen = distort(camera.distortion, point.head<2>() / point.z(), nullptr);
  return {camera.fx * seen.x() + camera.cx, camera.fy * seen.y() + camera.cy};
}

Eigen::Vector3d pixel_ray(const CameraIntrinsics& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d seen((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  Eigen::Vector2d ideal = seen, best = seen;
  double best_error = INFINITY;
  for (int step = 0; step < 30; ++step) {
    Eigen::Matrix2d derivative;
    const Eigen::Vector2d error = distort(camera.distortion, ideal, &derivative) - seen;
    if (!(error.norm() < best_error)) break;
    best = ideal;
    best_error = error.norm();
    if (best_error < 1e-15) break;
    ideal -= derivative.inverse() * error;
  }
  return best.homogeneous();
}

}  // namespace clearway
