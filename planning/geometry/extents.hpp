#pragma once

// Not part of the installed library.

#include <Eigen/Core>
#include <algorithm>

/// Small sums that several kinds of shape need.
namespace clearway::extents {

/// Distance from what extends so far along each own direction, negative inside.
/// @param beyond how far outside along each
template <typename Vector>
double distance(const Vector& beyond) {
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

/// What a value is past [-half, half].
inline double past(double value, double half) { return value - std::clamp(value, -half, half); }

inline double sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

}  // namespace clearway::extents
