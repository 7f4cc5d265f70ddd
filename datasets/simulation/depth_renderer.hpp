#pragma once

#include <span>

#include "datasets/simulation/surface.hpp"

namespace clearway {

/// The depth image number `index` of a scene, counted over all passes: exact distance along the ray of each
/// pixel's centre, then noise and dropouts of its own for each (seed, index).
DepthImage render_depth(const SceneDepth& depth, size_t index, std::span<const Surface> surfaces,
                        uint64_t seed);

/// Makes every range the largest whole number of the image's units that does not exceed it, as a sensor that
/// counts the steps gone by: what is stored is never behind the surface. Rounding to the nearest step would
/// be, by up to half a unit, and a slanted ray would then clear voxels inside a surface that lies on a
/// voxel's face.
void count_whole_steps(DepthImage& image);

}  // namespace clearway
