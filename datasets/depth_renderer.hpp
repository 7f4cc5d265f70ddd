#pragma once

#include <span>

#include "datasets/surface.hpp"

namespace clearway {

/// The depth image number `index` of a scene: exact distance along the ray of each pixel's centre, then noise
/// and dropouts of its own for each (seed, index).
DepthImage render_depth(const SceneDepth& depth, size_t index, std::span<const Surface> surfaces,
                        uint64_t seed);

}  // namespace clearway
