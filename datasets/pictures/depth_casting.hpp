#pragma once

#include <filesystem>
#include <vector>

#include "datasets/pictures/depth_scale.hpp"
#include "datasets/pictures/files_in_child.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// The cameras of depth pictures, one after the other.
struct DepthCameras {
  std::vector<CameraIntrinsics> of_picture;
  bool may_be_resized = false;  ///< depth may be smaller than the pictures that the cameras are of
};

/// The pictures of confidence that are called as those of depth are, perhaps with `_conf` behind; empty where
/// there is none.
std::vector<std::filesystem::path> confidence_of(const std::vector<std::filesystem::path>& pictures,
                                                 const std::filesystem::path& folder);

/// What makes clouds of kind "depth" of pictures' bytes, cast through the lens of their camera: x forward, y
/// left, z up.
/// @param cameras one of all, or each picture's @param options their `scale` is known
/// @param confidence of each picture, that of its confidence: where it is 0 there is no depth; empty: none
FilesInChild::Decode depth_decoder(const DepthCameras& cameras, const DepthOptions& options,
                                   const DepthNumbers& numbers,
                                   const std::vector<std::filesystem::path>& confidence);

}  // namespace clearway
