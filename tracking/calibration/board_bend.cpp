#include "tracking/calibration/board_bend.hpp"

namespace clearway {
namespace {

Eigen::Matrix2d matrix_of(const Eigen::Vector3d& c) {
  Eigen::Matrix2d k;
  k << c[0], c[1], c[1], c[2];
  return k;
}

}  // namespace

/// The stretched point, in the plane's frame.
Eigen::Vector3d BoardBend::on_plane(const Eigen::Vector3d& flat) const {
  const Eigen::Vector3d point = board_from_plane.inverse() * flat;
  return {(1.0 + 0.5 * stretch) * point.x(), (1.0 - 0.5 * stretch) * point.y(), point.z()};
}

// Along a circle of curvature k the arc s ends at sin(k s) / k, that is s - k^2 s^3 / 6.
Eigen::Vector3d BoardBend::bent(const Eigen::Vector3d& flat) const {
  if (curvatures.isZero(0.0) && stretch == 0.0) return flat;
  Eigen::Vector3d point = on_plane(flat);
  const Eigen::Vector2d p = point.head<2>(), slope = matrix_of(curvatures) * p;
  const double twice_height = p.dot(slope);
  point.head<2>() -= twice_height / 6.0 * slope;
  point.z() += 0.5 * twice_height;
  return board_from_plane * point;
}

/// The derivative of the bent point by the stretched one, both in the plane's frame.
Eigen::Matrix3d BoardBend::by_stretched(const Eigen::Vector3d& stretched) const {
  const Eigen::Vector2d p = stretched.head<2>();
  const Eigen::Matrix2d k = matrix_of(curvatures);
  const Eigen::Vector2d slope = k * p;
  Eigen::Matrix3d by = Eigen::Matrix3d::Identity();
  by.topLeftCorner<2, 2>() -= (2.0 * slope * slope.transpose() + p.dot(slope) * k) / 6.0;
  by.bottomLeftCorner<1, 2>() = slope.transpose();
  return by;
}

Eigen::Matrix3d BoardBend::by_point(const Eigen::Vector3d& flat) const {
  const Eigen::Vector3d longer(1.0 + 0.5 * stretch, 1.0 - 0.5 * stretch, 1.0);
  return board_from_plane.linear() * by_stretched(on_plane(flat)) * longer.asDiagonal() *
         board_from_plane.linear().transpose();
}

Eigen::Vector3d BoardBend::by_stretch(const Eigen::Vector3d& flat) const {
  const Eigen::Vector3d point = board_from_plane.inverse() * flat;
  return board_from_plane.linear() *
         (by_stretched(on_plane(flat)) * Eigen::Vector3d(0.5 * point.x(), -0.5 * point.y(), 0.0));
}

Eigen::Matrix3d BoardBend::by_curvatures(const Eigen::Vector3d& flat) const {
  const Eigen::Vector2d p = on_plane(flat).head<2>();
  const Eigen::Vector2d slope = matrix_of(curvatures) * p;
  Eigen::Matrix3d by;
  for (int i = 0; i < kBendUnknowns; ++i) {
    const Eigen::Vector2d slope_by = matrix_of(Eigen::Vector3d::Unit(i)) * p;
    const double by_height = p.dot(slope_by);
    by.col(i) << -(by_height * slope + p.dot(slope) * slope_by) / 6.0, 0.5 * by_height;
  }
  return board_from_plane.linear() * by;
}

}  // namespace clearway
