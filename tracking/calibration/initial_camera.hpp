#pragma once

#include "tracking/calibration/bundle.hpp"

namespace clearway {

/// The plane of all tags of a board.
struct BoardPlane {
  Eigen::Isometry3d board_from_plane = Eigen::Isometry3d::Identity();
  double thickness = 0.0;  ///< metres
  double reach = 0.0;      ///< metres, from its origin, the corners' middle, to the farthest corner
};

/// The plane through the corners of a board's tags that is nearest to them; its z as the first tag's, its
/// x along that tag's sides.
/// @pre a tag
BoardPlane plane_of(const TagBody& board);

/// Where a bundle adjustment begins: camera and poses by OpenCV (Zhang 2000); the poses alone, of a usual
/// camera, when `is_guess`. False when it finds none that is plausible.
bool find_initial_camera(Bundle& bundle, const BoardPlane& plane, bool is_guess);

/// The same of a fisheye: the equidistant one that explains the views best, of focal lengths that show 35 to
/// 125 degrees in the image's corners. Views and tags that it does not see are left out. False when it sees
/// less than half of the views.
bool find_initial_fisheye(Bundle& bundle, const BoardPlane& plane);

/// The same of a rational lens: one that bends as the equidistant fisheye does, or the plumb bob that
/// find_initial_camera finds, whichever explains the views better.
bool find_initial_rational(Bundle& bundle, const BoardPlane& plane);

}  // namespace clearway
