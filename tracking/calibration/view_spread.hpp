#pragma once

#include "tracking/calibration/bundle.hpp"
#include "tracking/calibration/initial_camera.hpp"

namespace clearway {

/// Share of the image in which a view shows the board: inside the convex hull of the corners seen in it.
double coverage_of(const Camera& camera, const std::vector<BoardView>& views);

/// The tilt against the image that one in ten views exceeds, radians.
double widest_tilt(const std::vector<BoardView>& views, const BoardPlane& plane);

/// By how much the board was turned about the line of sight between the two views that differ most: radians,
/// at most a quarter turn, for upside down is not otherwise turned.
double widest_roll(const std::vector<BoardView>& views, const BoardPlane& plane);

}  // namespace clearway
