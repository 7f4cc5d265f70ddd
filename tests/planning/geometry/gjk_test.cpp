// Simplices against what makes a point of a hull the nearest to the origin: no corner lies on its near side.

#include "planning/geometry/gjk.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace gjk_test {

SupportPoint drawn(Random& random, const Eigen::Vector3d& middle) {
  SupportPoint point;
  point.a = random.point(1.0);
  point.difference = middle + random.point(1.0);
  point.b = point.a + point.difference;
  return point;
}

/// Weights that are none below 0 and 1 in all, of corners that were given, whose mix the nearest point is.
void expect_mix(const Simplex& simplex) {
  double sum = 0.0;
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
  for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.size); ++i) {
    EXPECT_GT(simplex.weights[i], 0.0);
    sum += simplex.weights[i];
    a += simplex.weights[i] * simplex.points[i].a;
    b += simplex.weights[i] * simplex.points[i].b;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_LT((simplex.nearest_a() - a).norm(), 1e-12);
  EXPECT_LT((simplex.nearest_b() - b).norm(), 1e-12);
  EXPECT_LT((simplex.nearest() - (b - a)).norm(), 1e-12);
}

/// Six times the volume of a tetrahedron, with its sign.
double volume(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Whether the origin is in the tetrahedron: on the inner side of each of its four faces.
bool holds_origin(const std::array<Eigen::Vector3d, 4>& corners) {
  const double whole = volume(corners[0], corners[1], corners[2], corners[3]);
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<Eigen::Vector3d, 4> moved = corners;
    moved[i] = Eigen::Vector3d::Zero();
    if (volume(moved[0], moved[1], moved[2], moved[3]) * whole < 0.0) return false;
  }
  return true;
}

/// Corners are added as GJK does: each lies beyond the plane through what was nearest so far.
TEST(Simplex, KeepsTheCornersWhoseMixIsNearestToTheOriginOrFindsThatItIsInside) {
  Random random(1);
  std::array<int, 5> sizes{};
  int inside = 0;
  for (int trial = 0; trial < 4'000; ++trial) {
    const Eigen::Vector3d middle = random.point(1.5);
    Simplex simplex;
    for (int added = 0; added < 12; ++added) {
      const SupportPoint point = drawn(random, middle);
      if (simplex.size > 0) {
        const Eigen::Vector3d nearest = simplex.nearest();
        if (!(point.difference.dot(nearest) < nearest.squaredNorm() - 1e-3)) continue;
      }
      std::vector<Eigen::Vector3d> corners{point.difference};
      for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.size); ++i)
        corners.push_back(simplex.points[i].difference);
      const bool is_held =
          corners.size() == 4 && holds_origin({corners[0], corners[1], corners[2], corners[3]});
      ASSERT_EQ(simplex.add_and_reduce(point), is_held) << trial;
      if (is_held) {
        ++inside;
        break;
      }
      ++sizes[static_cast<std::size_t>(simplex.size)];
      expect_mix(simplex);
      const Eigen::Vector3d nearest = simplex.nearest();
      for (const Eigen::Vector3d& corner : corners)
        EXPECT_GE(corner.dot(nearest), nearest.squaredNorm() - 1e-9) << trial << " of " << corners.size();
    }
  }
  for (const std::size_t size : {1, 2, 3}) EXPECT_GT(sizes[size], 500) << size;
  EXPECT_GT(inside, 200);
}

TEST(Simplex, OfCornersInALineOrAPlaneTheNearestIsFoundToo) {
  Random random(2);
  for (int trial = 0; trial < 2'000; ++trial) {
    const Eigen::Vector3d at = random.point(1.0), u = random.point(1.0), v = random.point(1.0);
    const bool is_line = trial % 2 == 0;
    Simplex simplex;
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 3; ++i) {
      SupportPoint point;
      point.a = Eigen::Vector3d::Zero();
      point.b = point.difference =
          at + random.between(-2.0, 2.0) * u + (is_line ? 0.0 : random.between(-2.0, 2.0)) * v;
      const Eigen::Vector3d nearest = simplex.size > 0 ? simplex.nearest() : Eigen::Vector3d::Zero();
      if (simplex.size > 0 && !(point.difference.dot(nearest) < nearest.squaredNorm() - 1e-3)) continue;
      corners.assign({point.difference});
      for (std::size_t k = 0; k < static_cast<std::size_t>(simplex.size); ++k)
        corners.push_back(simplex.points[k].difference);
      ASSERT_FALSE(simplex.add_and_reduce(point));
    }
    expect_mix(simplex);
    for (const Eigen::Vector3d& corner : corners)
      EXPECT_GE(corner.dot(simplex.nearest()), simplex.nearest().squaredNorm() - 1e-9) << trial;
  }
}

}  // namespace gjk_test
}  // namespace clearway
