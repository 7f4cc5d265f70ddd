#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace clearway {

/// A closed surface of triangles. Metres.
struct ShapeSurface {
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
};

/// The surface of a solid of revolution about z: rings of 24 corners between the poles at `bottom` and `top`.
/// @param profile (distance from z, height) of the rings, rising, without the poles
ShapeSurface surface_of_revolution(const std::vector<Eigen::Vector2d>& profile, double bottom, double top);

/// Two half spheres of `radius` whose centres lie `length` apart on z, with what is between them.
ShapeSurface capsule_surface(double radius, double length);

ShapeSurface box_surface(const Eigen::Vector3d& edges);

}  // namespace clearway
