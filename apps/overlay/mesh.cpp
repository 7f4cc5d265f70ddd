#include "apps/overlay/mesh.hpp"

#include <cmath>
#include <numbers>

namespace clearway {
namespace {

/// Each triangle with corners of its own; the normal of a corner is the mean of the faces that meet there
/// without a sharp edge between, weighed by their areas.
Mesh with_normals(const ShapeSurface& surface) {
  static const double least_cosine = std::cos(40.0 * std::numbers::pi / 180.0);
  std::vector<Eigen::Vector3d> faces;  // twice the area long
  std::vector<std::vector<std::size_t>> around(surface.corners.size());
  for (const auto& triangle : surface.triangles) {
    const Eigen::Vector3d &a = surface.corners[triangle[0]], &b = surface.corners[triangle[1]],
                          &c = surface.corners[triangle[2]];
    for (const int corner : triangle) around[static_cast<std::size_t>(corner)].push_back(faces.size());
    faces.emplace_back((b - a).cross(c - a));
  }
  Mesh mesh;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(mesh.corners.size());
    for (const int corner : surface.triangles[t]) {
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      for (const std::size_t other : around[static_cast<std::size_t>(corner)])
        if (faces[other].dot(faces[t]) >= least_cosine * faces[other].norm() * faces[t].norm())
          normal += faces[other];
      mesh.corners.push_back(surface.corners[static_cast<std::size_t>(corner)]);
      mesh.normals.push_back(normal.normalized());
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace

Mesh mesh_of(const Shape& shape) { return with_normals(shape.surface()); }

Mesh mesh_of(const std::vector<VoxelQuad>& quads, double size) {
  Mesh mesh;
  mesh.corners.reserve(4 * quads.size());
  mesh.normals.reserve(4 * quads.size());
  mesh.triangles.reserve(2 * quads.size());
  for (const VoxelQuad& quad : quads) {
    const int axis = quad.direction / 2, side = quad.direction % 2;
    const auto first = static_cast<std::uint32_t>(mesh.corners.size());
    for (int i = 0; i < 4; ++i) {  // along u, then along v: counter-clockwise seen from +axis
      Eigen::Vector3d corner;
      corner[axis] = quad.layer + side;
      corner[(axis + 1) % 3] = quad.u + (i == 1 || i == 2 ? quad.width : 0U);
      corner[(axis + 2) % 3] = quad.v + (i >= 2 ? quad.height : 0U);
      mesh.corners.emplace_back((corner.array() - kOriginVoxel) * size);
      mesh.normals.emplace_back(Eigen::Vector3d::Unit(axis) * (side == 1 ? 1.0 : -1.0));
    }
    const std::uint32_t b = side == 1 ? 1 : 3, d = side == 1 ? 3 : 1;
    mesh.triangles.push_back({first, first + b, first + 2});
    mesh.triangles.push_back({first, first + 2, first + d});
  }
  return mesh;
}

Mesh transformed(const Mesh& mesh, const Eigen::Isometry3d& to_from_mesh) {
  Mesh moved = mesh;
  for (Eigen::Vector3d& corner : moved.corners) corner = to_from_mesh * corner;
  for (Eigen::Vector3d& normal : moved.normals) normal = to_from_mesh.linear() * normal;
  return moved;
}

void append(Mesh& mesh, const Mesh& more) {
  const auto shift = static_cast<std::uint32_t>(mesh.corners.size());
  mesh.corners.insert(mesh.corners.end(), more.corners.begin(), more.corners.end());
  mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
  for (const auto& t : more.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
}

}  // namespace clearway
