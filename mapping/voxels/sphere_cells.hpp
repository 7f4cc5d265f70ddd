#pragma once

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

// Which cubes of cells a sphere covers. Painting and repainting decide by these two functions alone, so that
// a voxel that was painted is found again to the last bit.

/// True when all of the cube lies inside the closed sphere.
bool covers(const Sphere& sphere, const CellCube& cube, double resolution);

/// True when at least one voxel of the cube lies wholly inside the sphere. The voxel with the nearest
/// farthest corner is, axis by axis, the one whose centre is nearest.
bool covers_some_voxel(const Sphere& sphere, const CellCube& cube, double resolution);

}  // namespace clearway
