#include "planning/geometry/shape_surface.hpp"

#include <cmath>
#include <numbers>

namespace clearway {
namespace {

constexpr int sides = 24;  ///< of what is round

}  // namespace

ShapeSurface surface_of_revolution(const std::vector<Eigen::Vector2d>& profile, double bottom, double top) {
  ShapeSurface surface;
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

ShapeSurface capsule_surface(double radius, double length) {
  constexpr int arcs = sides / 4;  // rings of a half sphere, its equator included
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
  return surface_of_revolution(profile, -radius - 0.5 * length, radius + 0.5 * length);
}

ShapeSurface box_surface(const Eigen::Vector3d& edges) {
  ShapeSurface surface;
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

}  // namespace clearway
