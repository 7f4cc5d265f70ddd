#pragma once

#include <cstdint>
#include <vector>

#include "datasets/ros/ros_messages.hpp"

namespace clearway {

/// A depth image unpacked.
struct UnpackedDepth {
  std::vector<std::uint8_t> bytes;
  RosImage image;  ///< 16UC1, or 32FC1 where its format says so; its data are the bytes
};

/// What compressed_depth_image_transport packs: behind 12 bytes of parameters a PNG of 16 bits, or RVL
/// (Wilson 2017, "Fast lossless depth image compression"). Of "32FC1" the steps are of inverse depth, as the
/// parameters say; 0 becomes NaN. A PNG of 16 bits that compressed_image_transport packs is read, too.
/// @throws std::runtime_error a clause that says why there is no depth image
UnpackedDepth unpack_depth(const RosCompressedImage& packed);

}  // namespace clearway
