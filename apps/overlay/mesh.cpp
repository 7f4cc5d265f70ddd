#include "apps/overlay/mesh.hpp"

#include <cmath>
#include <numbers>

#include "planning/geometry/convex_hull.hpp"

namespace clearway {
namespace {

constexpr int sides = 24;  ///< of what is round

/// Corners and triangles without normals.
struct Surface {
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::array<int, 3>> triangles;
};

/// Turned about z: rings of `sides` corners from the pole below to the pole above.
/// @param profile (distance from z, height) of the rings, rising, without the poles
Surface turned(const std::vector<Eigen::Vector2d>& profile, double bottom, double top) {
  Surface surface;
  surface.corners.emplace_back(0.0, 0.0, bottom);
  for (const Eigen::Vector2d& ring : profile)
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides;
      surface.corners.emplace_back(ring.x() * std::cos(angle), ring.x() * std::sin(angle), ring.y());
    }
  surface.corners.emplace_back(0.0, 0.0, top);
  const int last = static_cast<int>(surface.corners.size()) - 1, rings = static_cast<int>(profile.size());
  for (int i = 0; i < sides; ++i) {
    const int next = (i + 1) % sides;
    surface.triangles.push_back({0, 1 + next, 1 + i});
    for (int r = 0; r + 1 < rings; ++r) {
      const int low = 1 + r * sides, high = low + sides;
      surface.triangles.push_back({low + i, low + next, high + next});
      surface.triangles.push_back({low + i, high + next, high + i});
    }
    const int low = 1 + (rings - 1) * sides;
    surface.triangles.push_back({low + i, low + next, last});
  }
  return surface;
}

/// Half balls of `radius` whose centres are `length` apart on z.
Surface capsule(double radius, double length) {
  constexpr int arcs = sides / 4;  // rings of a half ball, its equator included
  std::vector<Eigen::Vector2d> profile;
  for (int half = 0; half < 2; ++half) {
    if (half == 1 && length == 0.0) profile.pop_back();  // one equator
    for (int i = 0; i < arcs; ++i) {
      const int step = half == 0 ? i + 1 - arcs : i;
      const double angle = 0.5 * std::numbers::pi * step / arcs;
      profile.emplace_back(radius * std::cos(angle),
                           radius * std::sin(angle) + (half == 0 ? -0.5 : 0.5) * length);
    }
  }
  return turned(profile, -radius - 0.5 * length, radius + 0.5 * length);
}

Surface box(const Eigen::Vector3d& edges) {
  Surface surface;
  for (int i = 0; i < 8; ++i)
    surface.corners.emplace_back(0.5 * (i & 1 ? edges.x() : -edges.x()),
                                 0.5 * (i & 2 ? edges.y() : -edges.y()),
                                 0.5 * (i & 4 ? edges.z() : -edges.z()));
  for (const std::array<int, 4>& face :
       {std::array{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    surface.triangles.push_back({face[0], face[1], face[2]});
    surface.triangles.push_back({face[0], face[2], face[3]});
  }
  return surface;
}

Surface surface_of(const Shape& shape) {
  switch (shape.kind()) {
    case Shape::Kind::sphere:
      return capsule(shape.radius(), 0.0);
    case Shape::Kind::capsule:
      return capsule(shape.radius(), shape.length());
    case Shape::Kind::cylinder:
      return turned({{shape.radius(), -0.5 * shape.length()}, {shape.radius(), 0.5 * shape.length()}},
                    -0.5 * shape.length(), 0.5 * shape.length());
    case Shape::Kind::box:
      return box(shape.edges());
    case Shape::Kind::convex:
      return {shape.vertices(), hull_triangles(shape.vertices())};
  }
  return {};
}

/// Each triangle with corners of its own; the normal of a corner is the mean of the faces that meet there
/// without a sharp edge between, weighed by their areas.
Mesh with_normals(const Surface& surface) {
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

Mesh mesh_of(const Shape& shape) { return with_normals(surface_of(shape)); }

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
