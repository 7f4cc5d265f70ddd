#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "datasets/simulation/surface.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// One depth image as it arrives.
struct Delivery {
  std::size_t image;                  ///< the pose of the scene that it was taken from
  Eigen::Isometry3d map_from_sensor;  ///< as stated, with all errors of the poses
  double time;                        ///< s since the first image was due, as stated
};

/// The images of a scene's depth camera in the order in which they arrive, over all its passes: dropped ones
/// are missing, repeated ones come twice. Image i was taken `i * depth.interval` seconds after the first; its
/// noise is that of number i, its true pose is depth.map_from_sensor[i % poses].
std::vector<Delivery> deliver_depth(const SceneDepth& depth, std::uint64_t seed);

/// Image number `image` as it is stored, in whole steps: with the scene's noise and systematic errors of
/// range, and with the camera that is stated, wrong by the calibration's errors. Its pose is the true one.
DepthImage photograph_depth(const SceneDepth& depth, std::size_t image, std::span<const Surface> surfaces,
                            std::uint64_t seed);

}  // namespace clearway
