#pragma once

#include <vector>

#include "apps/track/image_poses.hpp"
#include "tracking/annotated_image.hpp"

namespace clearway {

/// What `track --draw` draws: outlines of the tags with their ids (green: on a board whose pose is accepted;
/// red: refused; grey: on no board), the boards' axes (x red, y green, z blue) with their names, and the
/// outline of the ball.
std::vector<ImageMark> marks_of(const ImagePoses& poses, const Setup& setup, const Camera& camera);

}  // namespace clearway
