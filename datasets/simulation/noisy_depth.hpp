#pragma once

#include <span>

#include "datasets/simulation/surface.hpp"

namespace clearway {

/// What a structured-light camera (Kinect) adds to the exact depth of a pixel. All zero: nothing.
struct DepthNoise {
  double range_scale = 0.0;     ///< times sigma = 1.2 mm + 1.9 mm/m^2 (z - 0.4 m)^2 (Nguyen et al. 2012)
  double lateral_px = 0.0;      ///< sigma of where in the image a pixel looks; moves depth edges
  double flying = 0.0;          ///< share of such pixels at a depth edge that lie between both surfaces
  double disparity_step = 0.0;  ///< depths are steps of this many pixels of disparity, 0 = continuous
  double baseline = 0.075;      ///< between projector and camera, metres
  double grazing_cosine = 0.0;  ///< under this cosine to the normal, returns are lost: all at 0, none at it
  double dropout = 0.0;         ///< share of pixels without a return anywhere

  /// What a real one does: everything on.
  static DepthNoise structured_light() { return {1.0, 0.5, 0.3, 0.125, 0.075, 0.15, 0.01}; }
};

/// The depth image number `index` of a scene as a noisy camera would see it; noise of its own for each
/// (seed, index), independent of the number of threads. The noise of `depth` itself is not added.
DepthImage render_noisy_depth(const SceneDepth& depth, size_t index, std::span<const Surface> surfaces,
                              uint64_t seed, const DepthNoise& noise);

}  // namespace clearway
