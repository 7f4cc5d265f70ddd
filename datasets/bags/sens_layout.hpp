#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// Where some bytes of a file are.
struct FilePart {
  std::uint64_t at = 0, size = 0;
};

/// A frame of a .sens file.
struct SensFrame {
  std::optional<Eigen::Isometry3d> world_from_camera;  ///< optical frame, m; empty: not known
  bool is_bent = false;                                ///< its matrix is finite, and no rigid transform
  std::uint64_t depth_time = 0;                        ///< as it is stored, which are microseconds
  FilePart colour, depth;
};

/// What ScanNet's recorder wrote before and between the pictures of a .sens file (SensReader, sensorData.h,
/// version 4).
struct SensLayout {
  CameraIntrinsics colour, depth;
  bool is_depth_moved = false;   ///< the extrinsic of its depth camera is rigid, and not the identity
  bool is_depth_packed = false;  ///< by zlib; else as it is
  bool has_pictures = false;     ///< colours are PNG or JPEG; else they are not read
  bool is_untracked = false;     ///< all its poses were the identity, and were dropped
  double step = 0.0;             ///< m per step of depth
  std::vector<SensFrame> frames;
  std::string damage;  ///< a clause: why there are fewer frames than it says; "": there are not
};

/// Ends before a frame of no bytes, and after a million frames, so that no file asks for far more memory than
/// its size.
/// @param size of the file @param read gives `count` bytes from `at`, fewer at its end
/// @throws std::runtime_error a clause that says why it is none, or is not read here
SensLayout read_sens_layout(std::uint64_t size,
                            const std::function<std::string(std::uint64_t at, std::size_t count)>& read);

/// The steps of a depth picture of such a file as a PGM of 16 bits. @throws std::runtime_error a clause where
/// its bytes are not those of a picture of this size
std::string pgm_of_sens(const std::string& bytes, const SensLayout& layout);

}  // namespace clearway
