#pragma once

#include <Eigen/Core>
#include <array>

namespace clearway {

/// A support point of the Minkowski difference B - A with the two points it comes from.
struct SupportPoint {
  Eigen::Vector3d difference = Eigen::Vector3d::Zero();
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
};

/// Up to four points of the Minkowski difference and the weights of the one point of their hull nearest the
/// origin.
struct Simplex {
  std::array<SupportPoint, 4> points;
  std::array<double, 4> weights{};
  int size = 0;

  /// Adds `point`, then drops every point that the nearest point of the hull does not need. The newest point
  /// is assumed to be needed, as in Gilbert, Johnson, Keerthi 1988. True when the hull holds the origin.
  bool add_and_reduce(const SupportPoint& point);

  Eigen::Vector3d nearest() const;    ///< of the hull to the origin
  Eigen::Vector3d nearest_a() const;  ///< its point on A
  Eigen::Vector3d nearest_b() const;  ///< its point on B
};

}  // namespace clearway
