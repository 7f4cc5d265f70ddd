#include "mapping/voxels/ball_cells.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {

bool covers(const Sphere& ball, const CellCube& cube, double resolution) {
  double farthest_corner_squared = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::abs(cube.corner[axis] * resolution - ball.center[axis]);
    const double high = std::abs((cube.corner[axis] + cube.edge) * resolution - ball.center[axis]);
    const double far = std::max(low, high);
    farthest_corner_squared += far * far;
  }
  return farthest_corner_squared <= ball.radius * ball.radius;
}

bool covers_some_voxel(const Sphere& ball, const CellCube& cube, double resolution) {
  CellCube voxel;
  voxel.edge = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(ball.center[axis] / resolution);
    voxel.corner[axis] = static_cast<int>(std::clamp(cell, static_cast<double>(cube.corner[axis]),
                                                     static_cast<double>(cube.corner[axis] + cube.edge - 1)));
  }
  return covers(ball, voxel, resolution);
}

}  // namespace clearway
