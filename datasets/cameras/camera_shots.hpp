#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "datasets/cameras/path_fields.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// One picture of a camera that moved.
struct CameraShot {
  /// Files, relative to where the path lies, or the picture's number; empty: not stated.
  std::string picture, depth;
  std::optional<Eigen::Isometry3d> world_from_camera;  ///< optical frame, m; empty: not stated
  std::optional<CameraIntrinsics> camera;              ///< empty: not stated, or not its size
  std::optional<double> time = {};                     ///< s; empty: not stated
};

/// The way of a camera as programs write it as JSON that look for it, or that are to show it.
struct CameraPath {
  std::vector<CameraShot> shots;
  std::optional<double> depth_scale;  ///< m per step of depth pictures; empty: not stated
  bool is_named = false;              ///< shots name their pictures; else they are in the order of these
  bool is_numbered = false;           ///< shots state their pictures' numbers (BOP)
  bool has_image_names = false;       ///< COLMAP's images.txt
  bool is_of_colmap = false;          ///< COLMAP found the poses: their unit is not known
  bool is_scale_of_integers = false;  ///< depth_scale is that of whole numbers alone
  std::string note;                   ///< of poses and cameras, behind the file's name; empty: none
  std::string lack;                   ///< what was expected of a path without poses; empty: it has some

  /// Whether all of them state their camera, or any of them its pose.
  bool has_cameras() const;
  bool has_poses() const;
};

/// The transform of 12 or 16 numbers, rows of its matrix. Fails as `field`, where it is not rigid.
Eigen::Isometry3d rigid_of(const std::vector<double>& rows, const PathFields& field, const char* expected);

}  // namespace clearway
