#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "apps/pages/voxel_faces.hpp"
#include "planning/geometry/shape.hpp"

namespace clearway {

/// A closed surface to draw. Metres.
struct Mesh {
  std::vector<Eigen::Vector3d> corners;
  std::vector<Eigen::Vector3d> normals;                 ///< one per corner, outwards, unit
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
};

/// The surface of an exact body, in the shape's frame. Edges sharper than 40 degrees stay sharp in the
/// normals. Empty for a convex body that spans no volume.
Mesh mesh_of(const Shape& shape);

/// Faces of voxels, map frame. @param size edge of the finest voxel, metres
Mesh mesh_of(const std::vector<VoxelQuad>& quads, double size);

/// The mesh in another frame.
Mesh transformed(const Mesh& mesh, const Eigen::Isometry3d& to_from_mesh);

/// Adds all of `more` to `mesh`.
void append(Mesh& mesh, const Mesh& more);

}  // namespace clearway
