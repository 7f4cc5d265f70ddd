#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mapping/volumes/painted_body.hpp"

namespace clearway {

/// Squared distance between a segment and a box (closed), exact but for rounding; 0 when they meet.
double segment_box_squared(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::AlignedBox3d& box);

/// Least distance from the axis of a cylinder to the part of the box between the planes of its ends;
/// infinity when there is none. The cylinder meets the box when it is at most the radius.
double axis_distance_between_ends(const Cylinder& cylinder, const Eigen::AlignedBox3d& box);

}  // namespace clearway
