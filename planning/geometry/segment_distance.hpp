#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace clearway {

/// Two nearest points and the distance between them.
struct NearestPair {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double distance = 0.0;
};

/// Segment a0-a1 against segment b0-b1; either may be a point. Exact up to rounding (Ericson, "Real-Time
/// Collision Detection", 2005, sec. 5.1.9).
NearestPair segment_to_segment(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                               const Eigen::Vector3d& b0, const Eigen::Vector3d& b1);

/// The squared distance alone, for loops, of the segments a + s u and b + t v with s and t in [-1, 1]. Of
/// segments that are parallel within 1e-7 it may be too large by that share of their length.
inline double squared_segment_gap(const Eigen::Vector3d& a, const Eigen::Vector3d& u,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& v) {
  const Eigen::Vector3d w = a - b;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const auto on_segment = [](double value) { return std::clamp(value, -1.0, 1.0); };
  const double determinant = uu * vv - uv * uv;
  double s = determinant > 1e-14 * uu * vv ? on_segment((uv * vw - vv * uw) / determinant) : 0.0;
  const double free = vv > 0.0 ? (vw + s * uv) / vv : 0.0, t = on_segment(free);
  if (t != free || determinant <= 1e-14 * uu * vv) s = uu > 0.0 ? on_segment((t * uv - uw) / uu) : 0.0;
  return (w + s * u - t * v).squaredNorm();
}

/// Segment a0-a1 (may be a point) against the box [-half, half]. Exact up to rounding: the squared distance
/// along the segment is convex and quadratic between the crossings of the box's six planes.
NearestPair segment_to_box(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& half);

}  // namespace clearway
