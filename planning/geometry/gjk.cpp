#include "planning/geometry/gjk.hpp"

#include <Eigen/Dense>
#include <limits>

namespace clearway {
namespace {

/// The part of a simplex that was found nearest so far.
struct Choice {
  std::array<int, 4> index{};
  std::array<double, 4> weight{};
  int size = 0;
  double squared = std::numeric_limits<double>::infinity();
};

void consider(const Simplex& simplex, Choice& best, const std::array<int, 4>& index,
              const std::array<double, 4>& weight, int size) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (int i = 0; i < size; ++i) {
    point += weight[static_cast<std::size_t>(i)] *
             simplex.points[static_cast<std::size_t>(index[static_cast<std::size_t>(i)])].difference;
  }
  if (point.squaredNorm() < best.squared) best = {index, weight, size, point.squaredNorm()};
}

/// Nearest point on the edge new-other, when it lies inside the edge.
void consider_edge(const Simplex& s, Choice& best, int n, int i) {
  const Eigen::Vector3d& p = s.points[static_cast<std::size_t>(n)].difference;
  const Eigen::Vector3d edge = s.points[static_cast<std::size_t>(i)].difference - p;
  const double t = -p.dot(edge) / edge.squaredNorm();  // of one without length no number
  if (t > 0.0 && t < 1.0) consider(s, best, {n, i}, {1.0 - t, t}, 2);
}

/// Nearest point on the triangle new-i-j, when it lies inside the triangle.
void consider_triangle(const Simplex& s, Choice& best, int n, int i, int j) {
  const Eigen::Vector3d& p = s.points[static_cast<std::size_t>(n)].difference;
  const Eigen::Vector3d u = s.points[static_cast<std::size_t>(i)].difference - p;
  const Eigen::Vector3d v = s.points[static_cast<std::size_t>(j)].difference - p;
  const Eigen::Vector3d normal = u.cross(v);
  const double squared = normal.squaredNorm();  // of a flat one rounding alone: any weights, or no numbers
  const double wu = -p.cross(v).dot(normal) / squared;
  const double wv = -u.cross(p).dot(normal) / squared;
  if (wu > 0.0 && wv > 0.0 && wu + wv < 1.0) consider(s, best, {n, i, j}, {1.0 - wu - wv, wu, wv}, 3);
}

/// Whether the tetrahedron of the four points holds the origin.
bool holds_origin(const Simplex& s) {
  Eigen::Matrix3d edges;
  for (int i = 0; i < 3; ++i)
    edges.col(i) = s.points[static_cast<std::size_t>(i)].difference - s.points[3].difference;
  const double determinant = edges.determinant();
  const double size = edges.colwise().norm().prod();
  if (std::abs(determinant) <= 1e-14 * size) return false;
  const Eigen::Vector3d weights = -edges.inverse() * s.points[3].difference;
  return weights.minCoeff() >= 0.0 && weights.sum() <= 1.0;
}

}  // namespace

bool Simplex::add_and_reduce(const SupportPoint& point) {
  const int newest = size++;
  points[static_cast<std::size_t>(newest)] = point;
  if (size == 4 && holds_origin(*this)) return true;
  Choice best;
  consider(*this, best, {newest}, {1.0}, 1);
  for (int i = 0; i < newest; ++i) {
    consider_edge(*this, best, newest, i);
    for (int j = i + 1; j < newest; ++j) consider_triangle(*this, best, newest, i, j);
  }
  const std::array<SupportPoint, 4> old = points;
  size = best.size;
  weights = best.weight;
  for (int i = 0; i < size; ++i) {
    points[static_cast<std::size_t>(i)] =
        old[static_cast<std::size_t>(best.index[static_cast<std::size_t>(i)])];
  }
  return false;
}

Eigen::Vector3d Simplex::nearest() const { return nearest_b() - nearest_a(); }

Eigen::Vector3d Simplex::nearest_a() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < size; ++i)
    sum += weights[static_cast<std::size_t>(i)] * points[static_cast<std::size_t>(i)].a;
  return sum;
}

Eigen::Vector3d Simplex::nearest_b() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < size; ++i)
    sum += weights[static_cast<std::size_t>(i)] * points[static_cast<std::size_t>(i)].b;
  return sum;
}

}  // namespace clearway
