#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "tracking/camera.hpp"

namespace clearway {

/// One pose of a square tag that explains its four corners.
struct TagPoseSolution {
  Eigen::Isometry3d camera_from_tag = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;  ///< root mean square distance of the four projected corners to the seen ones
};

/// Both poses of a planar square, the better one first. A small tag seen from afar is explained almost
/// equally well by two tilts; which one is true, one image of one tag may not decide.
struct TagPose {
  std::vector<TagPoseSolution> solutions;  ///< none, one or two; rms rising

  bool empty() const { return solutions.empty(); }
  /// rms of the second solution over that of the first; infinity when there is only one (or the first is
  /// exact). Near 1 the choice between the two is a coin toss.
  double ambiguity_ratio() const;
};

/// The corners of a tag of side `size` (metres, the black square) in its own frame (x right, y up, z out of
/// the tag towards the viewer), in the order of TagDetection::corners.
std::array<Eigen::Vector3d, 4> tag_corners(double size);

/// True when the camera sees the tag's front: a printed tag cannot be decoded from behind.
bool faces_camera(const Eigen::Isometry3d& camera_from_tag);

/// IPPE-square (Collins and Bartoli 2014, OpenCV). `corners` in pixels and in the order of
/// TagDetection::corners. Solutions that would show the tag's back, lie behind the camera or are not finite
/// are left out; a degenerate input (not finite, collinear, crossed or tiny corners; a corner no ray of the
/// lens reaches) gives none. Throws std::invalid_argument when `size` is not finite and > 0.
TagPose estimate_tag_pose(const std::array<Eigen::Vector2d, 4>& corners, double size, const Camera& camera);

}  // namespace clearway
