#pragma once

#include <string>

#include "apps/track/image_poses.hpp"

namespace clearway {

// Poses as text; datasets/FORMATS.md describes every column and key.

/// The first line of the CSV form.
std::string poses_csv_header();
/// One line a pose; an image without any, or refused as a whole, is one line of kind "image".
std::string to_csv(const ImagePoses& poses);

/// One JSON object of one image, without a line's end.
std::string to_json(const ImagePoses& poses);

/// "time x y z qx qy qz qw", a line as the TUM RGB-D benchmark has it.
std::string tum_line(double time, const Eigen::Isometry3d& pose);

}  // namespace clearway
