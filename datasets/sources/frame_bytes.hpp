#pragma once

#include <string>
#include <string_view>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// A frame as the decoding child hands it over.
struct DecodedFrame {
  static constexpr double unknown_time = -1;  ///< before the first object with a time stamp

  Frame frame;         ///< its pose is on the robot until `posed`
  bool posed = false;  ///< the pose is already in the world (logs of actions and sensory frames)
};

/// Our own byte form of a frame, for the pipe between the decoding child and the reader.
std::string frame_to_bytes(const DecodedFrame& frame);

/// The inverse. The child may have died with its memory in ruins, so nothing is taken on trust: sizes must
/// fit, numbers must be finite, poses must be rigid. @throws std::runtime_error otherwise.
DecodedFrame frame_from_bytes(std::string_view bytes);

}  // namespace clearway
