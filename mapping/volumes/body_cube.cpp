#include "mapping/volumes/body_cube.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace clearway {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double segment_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0.0 ? std::clamp(-a.dot(along) / squared, 0.0, 1.0) : 0.0;
  return (a + t * along).norm();
}

/// True when the points lie around the origin: no half turn without one.
bool surround_origin(const Points& points) {
  std::vector<double> angles;
  for (const Eigen::Vector2d& p : points) angles.push_back(std::atan2(p.y(), p.x()));
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) widest = std::max(widest, angles[i] - angles[i - 1]);
  return widest <= std::numbers::pi;
}

/// From the origin to the convex hull of the points. Its edges are among all pairs, which lie in it.
double hull_distance(const Points& points) {
  if (points.empty()) return HUGE_VAL;
  if (surround_origin(points)) return 0.0;
  double least = points.front().norm();
  for (std::size_t i = 1; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, segment_distance(points[i], points[j]));
  }
  return least;
}

}  // namespace

double segment_box_squared(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d along = b - a;
  // The squared distance is convex along the segment and a parabola between the planes of the box's faces.
  std::array<double, 8> turns{0.0, 1.0};  // in order
  std::size_t count = 2;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double face : {box.min()[axis], box.max()[axis]}) {
      const double t = (face - a[axis]) / along[axis];
      if (!(t > 0.0 && t < 1.0)) continue;
      std::size_t place = count++;
      for (; turns[place - 1] > t; --place) turns[place] = turns[place - 1];
      turns[place] = t;
    }
  }
  double least = std::min(box.squaredExteriorDistance(a), box.squaredExteriorDistance(b));
  for (std::size_t k = 1; k < count; ++k) {
    const Eigen::Vector3d middle = a + 0.5 * (turns[k - 1] + turns[k]) * along;
    double slope = 0.0, bend = 0.0;  // of half the parabola, at the start of the segment
    for (int axis = 0; axis < 3; ++axis) {
      const bool below = middle[axis]<box.min()[axis], above = middle[axis]> box.max()[axis];
      if (!below && !above) continue;
      slope += along[axis] * (a[axis] - (below ? box.min()[axis] : box.max()[axis]));
      bend += along[axis] * along[axis];
    }
    const double t = bend > 0.0 ? std::clamp(-slope / bend, turns[k - 1], turns[k]) : turns[k - 1];
    least = std::min(least, box.squaredExteriorDistance(Eigen::Vector3d(a + t * along)));
  }
  return least;
}

double axis_distance_between_ends(const Cylinder& cylinder, const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d axis = (cylinder.b - cylinder.a).normalized();
  const double length = (cylinder.b - cylinder.a).norm();
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  std::array<Eigen::Vector3d, 8> corners;  // along u, v and the axis
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3d p = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)) - cylinder.a;
    corners[i] = {p.dot(u), p.dot(v), p.dot(axis)};
  }
  // Corners of what is left between the end planes: the box's own, and where its edges cross the planes.
  Points points;
  for (unsigned i = 0; i < 8; ++i) {
    if (corners[i].z() >= 0.0 && corners[i].z() <= length) points.emplace_back(corners[i].head<2>());
    for (const unsigned bit : {1U, 2U, 4U}) {
      if ((i & bit) != 0) continue;
      const Eigen::Vector3d &p = corners[i], &q = corners[i | bit];
      for (const double plane : {0.0, length}) {
        const double t = (plane - p.z()) / (q.z() - p.z());
        if (t >= 0.0 && t <= 1.0) points.emplace_back((p + t * (q - p)).head<2>());
      }
    }
  }
  return hull_distance(points);
}

}  // namespace clearway
