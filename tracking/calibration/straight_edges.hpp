#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "tracking/calibration/bundle.hpp"

namespace clearway {

/// Where a detector finds the corners of a tag, pixels: it fits a straight line to each edge (apriltag's
/// refine_edges), and a lens that bends edges puts these lines, and where they meet, beside the corners: of a
/// fisheye at 60 pixels a side by 0.8. An edge counts as a parabola through its ends and its middle.
/// Empty where one of them is out of sight.
std::optional<std::array<Eigen::Vector2d, 4>> corners_by_straight_edges(
    const Camera& camera, const MountedTag& tag, const BoardBend& bend,
    const Eigen::Isometry3d& camera_from_board);

}  // namespace clearway
