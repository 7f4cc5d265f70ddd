#pragma once

#include <span>

#include "datasets/simulation/surface.hpp"

namespace clearway {

/// The depth image number `index` of a scene as a noisy camera would see it; noise of its own for each
/// (seed, index), independent of the number of threads. The noise of `depth` itself is not added.
DepthImage render_noisy_depth(const SceneDepth& depth, size_t index, std::span<const Surface> surfaces,
                              uint64_t seed, const DepthNoise& noise);

}  // namespace clearway
