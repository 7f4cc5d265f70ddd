#pragma once

// Not part of the installed library.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace clearway {

/// The first of the points (at least one) that is farthest along the direction: that with the largest
/// direction.dot(point), by products and sums of doubles as Eigen forms them, on every machine.
std::size_t farthest_vertex(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction);

/// The first of the points (at least one) that is farthest from `point`, by squared distances in the same
/// way.
std::size_t farthest_from(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& point);

/// The largest squared distance of the points (at least one) from the origin, in the same way.
double largest_squared_norm(const std::vector<Eigen::Vector3d>& points);

}  // namespace clearway
