#pragma once

#include <Eigen/Core>

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

/// Segment a0-a1 (may be a point) against the box [-half, half]. Exact up to rounding: the squared distance
/// along the segment is convex and quadratic between the crossings of the box's six planes.
NearestPair segment_to_box(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& half);

}  // namespace clearway
