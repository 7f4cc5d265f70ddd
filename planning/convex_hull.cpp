#include "planning/convex_hull.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <tuple>

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

/// Indices of hull corners, or nothing when qhull refuses. Qhull reports to /dev/null: libraries are silent.
std::vector<int> qhull_corners(std::vector<double>& coordinates, int count) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> silence(std::fopen("/dev/null", "w"), &std::fclose);
  if (!silence) return {};
  qhT state;
  QHULL_LIB_CHECK
  qh_zero(&state, silence.get());
  char command[] = "qhull Qc";
  std::vector<int> corners;
  if (qh_new_qhull(&state, 3, count, coordinates.data(), False, command, nullptr, silence.get()) == 0) {
    const vertexT* vertex;
    for (vertex = state.vertex_list; vertex && vertex->next; vertex = vertex->next) {
      corners.push_back(qh_pointid(&state, vertex->point));
    }
    // Points that qhull set aside as coplanar within its rounding: kept, so that the hull never shrinks.
    for (facetT* facet = state.facet_list; facet && facet->next; facet = facet->next) {
      if (!facet->coplanarset) continue;
      for (void** point = &facet->coplanarset->e[0].p; *point; ++point) {
        corners.push_back(qh_pointid(&state, static_cast<pointT*>(*point)));
      }
    }
  }
  qh_freeqhull(&state, !qh_ALL);
  int current = 0, total = 0;
  qh_memfreeshort(&state, &current, &total);
  return corners;
}

}  // namespace

std::vector<Eigen::Vector3d> hull_corners(std::vector<Eigen::Vector3d> points) {
  remove_doubles(points);
  if (points.size() < 9) return points;
  std::vector<double> coordinates;
  coordinates.reserve(points.size() * 3);
  for (const Eigen::Vector3d& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
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

}  // namespace clearway
