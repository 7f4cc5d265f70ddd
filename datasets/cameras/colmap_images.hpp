#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace clearway {

/// A picture that COLMAP registered.
struct ColmapImage {
  std::string name;  ///< its file, relative to the folder of pictures
  /// Of the optical frame (x right, y down, z forward), in units of COLMAP's world, whose scale and axes are
  /// not known.
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
};

/// Whether a text is COLMAP's images.txt: its head says so, or its first line is that of an image; or the
/// bytes of its images.bin, of which the first image is one.
bool is_colmap_images(const std::string& text);

/// The images of it, in the order of the file (colmap.github.io, "Output Format"): two lines each,
/// `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`, which is camera_from_world, and the image's 2D points, an
/// empty line where it has none; in images.bin the same behind a count of images and of each one's points.
/// @param name what errors call the file
/// @throws std::invalid_argument naming `name`, the line or the image and what was expected
std::vector<ColmapImage> parse_colmap_images(const std::string& text, const std::string& name);

}  // namespace clearway
