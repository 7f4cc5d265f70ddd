#include "mapping/voxels/sphere_cells.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {

bool covers(const Sphere& sphere, const CellCube& cube, double resolution) {
  double farthest_corner_squared = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::abs(cube.corner[axis] * resolution - sphere.center[axis]);
    const double high = std::abs((cube.corner[axis] + cube.edge) * resolution - sphere.center[axis]);
    const double far = std::max(low, high);
    farthest_corner_squared += far * far;
  }
  return farthest_corner_squared <= sphere.radius * sphere.radius;
}

bool covers_some_voxel(const Sphere& sphere, const CellCube& cube, double resolution) {
  CellCube voxel;
  voxel.edge = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(sphere.center[axis] / resolution);
    voxel.corner[axis] = static_cast<int>(std::clamp(cell, static_cast<double>(cube.corner[axis]),
                                                     static_cast<double>(cube.corner[axis] + cube.edge - 1)));
  }
  return covers(sphere, voxel, resolution);
}

}  // namespace clearway
