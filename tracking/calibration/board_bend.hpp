#pragma once

#include <Eigen/Geometry>

namespace clearway {

constexpr int kBendUnknowns = 3;

/// How a flat board is bent, and its print stretched along one side: the second-order shape z = p^T K p / 2
/// over its plane, K of the curvatures below. Lengths from the plane's origin stay, to third order; a board
/// bent about one axis keeps all lengths.
struct BoardBend {
  Eigen::Isometry3d board_from_plane = Eigen::Isometry3d::Identity();  ///< z is the board's normal
  Eigen::Vector3d curvatures = Eigen::Vector3d::Zero();  ///< 1/m: along x, of x and y together, along y
  double stretch = 0.0;  ///< relative: half of it longer along the plane's x, half of it shorter along y

  /// Where a point of the flat board is on the bent one; both in the board's frame, as the derivatives are.
  Eigen::Vector3d bent(const Eigen::Vector3d& flat) const;
  Eigen::Matrix3d by_point(const Eigen::Vector3d& flat) const;
  Eigen::Matrix3d by_curvatures(const Eigen::Vector3d& flat) const;
  Eigen::Vector3d by_stretch(const Eigen::Vector3d& flat) const;

 private:
  Eigen::Vector3d on_plane(const Eigen::Vector3d& flat) const;
  Eigen::Matrix3d by_stretched(const Eigen::Vector3d& stretched) const;
};

}  // namespace clearway
