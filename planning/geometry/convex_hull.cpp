#include "planning/geometry/convex_hull.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <tuple>

#include "planning/geometry/farthest_vertex.hpp"

extern "C" {
#include <libqhull_r/libqhull_r.h>
}

namespace clearway {
namespace {

void remove_doubles(std::vector<Eigen::Vector3d>& points) {
  const auto key = [](const Eigen::Vector3d& p) { return std::tuple(p.x(), p.y(), p.z()); };
  std::sort(points.begin(), points.end(),
            [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return key(a) < key(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

/// Runs qhull on `coordinates` (x, y, z of `count` points) and hands its state to `read`; nothing is read
/// when qhull refuses. Qhull reports to /dev/null: libraries are silent.
template <typename Read>
void run_qhull(std::vector<double>& coordinates, int count, const char* options, const Read& read) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> silence(std::fopen("/dev/null", "w"), &std::fclose);
  if (!silence) return;
  qhT state;
  QHULL_LIB_CHECK
  qh_zero(&state, silence.get());
  std::string command = std::string("qhull ") + options;
  if (qh_new_qhull(&state, 3, count, coordinates.data(), False, command.data(), nullptr, silence.get()) ==
      0) {
    read(state);
  }
  qh_freeqhull(&state, !qh_ALL);
  int current = 0, total = 0;
  qh_memfreeshort(&state, &current, &total);
}

/// Indices of hull corners, or nothing when qhull refuses.
std::vector<int> qhull_corners(std::vector<double>& coordinates, int count) {
  std::vector<int> corners;
  run_qhull(coordinates, count, "Qc", [&](qhT& state) {
    for (vertexT* vertex = state.vertex_list; vertex && vertex->next; vertex = vertex->next) {
      corners.push_back(qh_pointid(&state, vertex->point));
    }
    // Points that qhull set aside as coplanar within its rounding: kept, so that the hull never shrinks.
    for (facetT* facet = state.facet_list; facet && facet->next; facet = facet->next) {
      if (!facet->coplanarset) continue;
      for (void** point = &facet->coplanarset->e[0].p; *point; ++point) {
        corners.push_back(qh_pointid(&state, static_cast<pointT*>(*point)));
      }
    }
  });
  return corners;
}

std::vector<double> flattened(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> coordinates;
  coordinates.reserve(points.size() * 3);
  for (const Eigen::Vector3d& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
  return coordinates;
}

}  // namespace

std::vector<Eigen::Vector3d> hull_corners(std::vector<Eigen::Vector3d> points) {
  remove_doubles(points);
  if (points.size() < 9) return points;
  std::vector<double> coordinates = flattened(points);
  std::vector<int> corners = qhull_corners(coordinates, static_cast<int>(points.size()));
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  if (corners.size() < 4 || corners.front() < 0 || corners.back() >= static_cast<int>(points.size()))
    return points;
  std::vector<Eigen::Vector3d> hull;
  hull.reserve(corners.size());
  for (int i : corners) hull.push_back(points[static_cast<std::size_t>(i)]);
  return hull;
}

std::vector<std::array<int, 3>> hull_triangles(const std::vector<Eigen::Vector3d>& points) {
  std::vector<std::array<int, 3>> triangles;
  if (points.size() < 4) return triangles;
  std::vector<double> coordinates = flattened(points);
  run_qhull(coordinates, static_cast<int>(points.size()), "Qt", [&](qhT& state) {
    for (facetT* facet = state.facet_list; facet && facet->next; facet = facet->next) {
      std::array<int, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = qh_pointid(&state, static_cast<vertexT*>(facet->vertices->e[i].p)->point);
      }
      const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(corners[i])]; };
      const Eigen::Vector3d outward(facet->normal[0], facet->normal[1], facet->normal[2]);
      if ((at(1) - at(0)).cross(at(2) - at(0)).dot(outward) < 0.0) std::swap(corners[1], corners[2]);
      triangles.push_back(corners);
    }
  });
  return triangles;
}

const std::vector<std::array<int, 3>>& HullTriangles::of(const std::vector<Eigen::Vector3d>& corners) const {
  std::call_once(found_, [&] { triangles_ = hull_triangles(corners); });
  return triangles_;
}

namespace {

/// A face: normal . x <= offset inside, normal of length 1.
struct Face {
  Eigen::Vector3d normal;
  double offset;
};

/// Those of the hull, each flat one once.
std::vector<Face> faces_of(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Face> faces;
  if (points.size() < 4) return faces;
  std::vector<double> coordinates = flattened(points);
  run_qhull(coordinates, static_cast<int>(points.size()), "", [&](qhT& state) {
    for (facetT* facet = state.facet_list; facet && facet->next; facet = facet->next)
      faces.push_back({{facet->normal[0], facet->normal[1], facet->normal[2]}, -facet->offset});
  });
  return faces;
}

}  // namespace

/// By duality: a plane normal . x = offset about an inner point is the point normal / offset, and the faces
/// of the hull of these points are the corners where the planes meet.
std::vector<Eigen::Vector3d> corners_behind_faces(const std::vector<Eigen::Vector3d>& points,
                                                  const Eigen::Vector3d& middle, double by) {
  std::vector<Eigen::Vector3d> dual, corners;
  for (const Face& face : faces_of(points)) {
    const double apart = face.offset - face.normal.dot(middle) - by;
    if (!(apart > 0.0)) return {};
    dual.emplace_back(face.normal / apart);
  }
  for (const Face& face : faces_of(dual)) {
    if (!(face.offset > 0.0)) return {};
    corners.emplace_back(middle + face.normal / face.offset);
  }
  return corners;
}

namespace {

/// Whether each side of a triangle is a side of exactly one other, the other way round.
bool is_closed(const std::vector<std::array<int, 3>>& triangles) {
  std::vector<std::uint64_t> sides;  // the lower corner, the higher one, which way: twins are neighbours
  sides.reserve(3 * triangles.size());
  for (const std::array<int, 3>& corners : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
      sides.push_back(std::uint64_t(low) << 32U | std::uint64_t(high) << 1U | (low == corners[i] ? 0U : 1U));
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const bool is_next = i == 0 || sides[i] > sides[i - 1];
    if (!is_next || i + 1 == sides.size() || sides[i] % 2 != 0 || sides[i + 1] != sides[i] + 1) return false;
  }
  return true;
}

}  // namespace

std::vector<std::array<int, 2>> surface_edges(const ShapeSurface& surface) {
  std::vector<std::array<int, 2>> edges;
  for (const std::array<int, 3>& corners : surface.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int from = corners[i], to = corners[(i + 1) % 3];
      if (from < to) edges.push_back({from, to});  // the neighbour has it the other way round
    }
  }
  return edges;
}

HullPlanes::HullPlanes(const ShapeSurface& hull) {
  if (hull.triangles.size() < 4 || !is_closed(hull.triangles)) return;
  const std::vector<Eigen::Vector3d>& points = hull.corners;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points) box.extend(point);
  const double margin = 1e-6 * box.sizes().maxCoeff();
  for (const auto& [a, b, c] : hull.triangles) {
    const auto at = [&](int i) -> const Eigen::Vector3d& { return points[static_cast<std::size_t>(i)]; };
    const Eigen::Vector3d normal = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
    const double offset = std::min({normal.dot(at(a)), normal.dot(at(b)), normal.dot(at(c))});
    // A triangle of no size has no normal: then no sphere is known to be inside.
    const bool is_outer = normal.dot(points[farthest_vertex(points, normal)]) <= offset + margin;
    if (!is_outer) {
      normals_.clear();
      offsets_.clear();
      return;
    }
    normals_.push_back(normal);
    offsets_.push_back(offset - margin);
  }
}

double HullPlanes::inner_radius(const Eigen::Vector3d& point) const {
  if (normals_.empty()) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < normals_.size(); ++i)
    least = std::min(least, offsets_[i] - normals_[i].dot(point));
  return least;
}

}  // namespace clearway
