#pragma once

// Not part of the installed library.

#include <Eigen/Core>

#include "planning/geometry/four_lanes.hpp"

namespace clearway {

/// Four points side by side.
struct FourPoints {
  lanes::Numbers x, y, z;

  static FourPoints all(const Eigen::Vector3d& point) {
    return {lanes::all(point.x()), lanes::all(point.y()), lanes::all(point.z())};
  }
  Eigen::Vector3d point(int lane) const { return {x[lane], y[lane], z[lane]}; }
  void set(int lane, const Eigen::Vector3d& point) {
    x.set(lane, point.x());
    y.set(lane, point.y());
    z.set(lane, point.z());
  }

  friend FourPoints operator+(const FourPoints& a, const FourPoints& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend FourPoints operator*(double a, const FourPoints& b) { return {a * b.x, a * b.y, a * b.z}; }
};

}  // namespace clearway
