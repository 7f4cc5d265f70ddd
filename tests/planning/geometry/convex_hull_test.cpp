#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <random>
#include <thread>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/shape.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace convex_hull_test {

double enclosed_volume(const std::vector<Eigen::Vector3d>& points) {
  double volume = 0.0;
  for (const auto& [a, b, c] : hull_triangles(points)) {
    volume += points[static_cast<std::size_t>(a)].dot(
                  points[static_cast<std::size_t>(b)].cross(points[static_cast<std::size_t>(c)])) /
              6.0;
  }
  return volume;
}

TEST(HullTriangles, a_box_encloses_its_volume_outwards) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1.0 : 0.0, i & 2 ? 2.0 : 0.0, i & 4 ? 3.0 : 0.0);
  EXPECT_EQ(hull_triangles(corners).size(), 12u);
  EXPECT_NEAR(enclosed_volume(corners), 6.0, 1e-12);
}

TEST(HullTriangles, no_point_lies_outside_and_every_edge_has_two_triangles) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  for (int round = 0; round < 50; ++round) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 40; ++i) points.emplace_back(side(random), side(random), side(random));
    const auto triangles = hull_triangles(points);
    std::map<std::pair<int, int>, int> edges;
    for (const auto& t : triangles) {
      const Eigen::Vector3d a = points[static_cast<std::size_t>(t[0])];
      const Eigen::Vector3d normal = (points[static_cast<std::size_t>(t[1])] - a)
                                         .cross(points[static_cast<std::size_t>(t[2])] - a)
                                         .normalized();
      for (const Eigen::Vector3d& p : points) EXPECT_LE(normal.dot(p - a), 1e-9);
      for (int e = 0; e < 3; ++e)
        ++edges[{t[static_cast<std::size_t>(e)], t[static_cast<std::size_t>((e + 1) % 3)]}];
    }
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ((edges.count({edge.second, edge.first})), 1u);
    }
  }
}

TEST(HullTriangles, flat_points_have_no_surface) {
  EXPECT_TRUE(hull_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}}).empty());
}

TEST(HullTriangles, are_found_once_and_those_of_a_scaled_hull_anew) {
  Random random(4);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 30; ++i) points.push_back(random.point(1.0));
  const Shape hull = Shape::convex(points), copy = hull, scaled = hull.scaled(0.5);
  const auto found = [](const Shape& shape) { return &shape.hull_triangles().of(shape.vertices()); };
  std::vector<const std::vector<std::array<int, 3>>*> seen(4);
  std::vector<std::jthread> threads;
  for (auto& place : seen) threads.emplace_back([&] { place = found(copy); });
  threads.clear();
  for (const auto* place : seen) EXPECT_EQ(place, found(hull));
  EXPECT_NE(found(scaled), found(hull));
  EXPECT_EQ(*found(hull), hull_triangles(hull.vertices()));
  EXPECT_EQ(*found(scaled), hull_triangles(scaled.vertices()));
}

TEST(SurfaceEdges, a_box_has_twelve_and_a_diagonal_on_each_side) {
  const auto edges = surface_edges(Shape::box({1.0, 1.0, 1.0}).surface());
  EXPECT_EQ(edges.size(), 18u);
  for (const auto& [a, b] : edges) EXPECT_LT(a, b);
}

TEST(HullPlanes, know_nothing_of_a_surface_that_does_not_close) {
  const ShapeSurface box = Shape::box({1.0, 1.0, 1.0}).surface();
  EXPECT_TRUE(HullPlanes(box).is_known());
  for (std::size_t i = 0; i < box.triangles.size(); ++i) {
    ShapeSurface open = box, twice = box, turned = box;
    open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(i));
    twice.triangles.push_back(box.triangles[i]);
    std::swap(turned.triangles[i][0], turned.triangles[i][1]);
    for (const ShapeSurface& surface : {open, twice, turned}) EXPECT_FALSE(HullPlanes(surface).is_known());
  }
  ShapeSurface two = box;
  two.triangles.insert(two.triangles.end(), box.triangles.begin(), box.triangles.end());
  EXPECT_FALSE(HullPlanes(two).is_known());
}

TEST(HullPlanes, inside_a_box_the_nearest_face_bounds_the_sphere) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1.0 : 0.0, i & 2 ? 2.0 : 0.0, i & 4 ? 3.0 : 0.0);
  const HullPlanes planes({corners, hull_triangles(corners)});
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.5, 1, 1.5), {0.1, 1, 1}, {0.9, 0.3, 2.8}}) {
    const double expected = std::min(point.minCoeff(), (Eigen::Vector3d(1, 2, 3) - point).minCoeff());
    EXPECT_NEAR(planes.inner_radius(point), expected, 4e-6);
    EXPECT_LT(planes.inner_radius(point), expected);
  }
  EXPECT_LT(planes.inner_radius({-0.1, 1, 1}), 0.0);
}

TEST(HullPlanes, spheres_lie_inside_and_could_not_be_much_larger) {
  std::mt19937 random(2);
  std::normal_distribution<double> side(0.0, 1.0);
  const auto draw = [&] { return Eigen::Vector3d(side(random), side(random), side(random)); };
  for (int round = 0; round < 30; ++round) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 30; ++i) points.push_back(draw());
    const HullPlanes planes({points, hull_triangles(points)});
    const Eigen::Vector3d middle = 0.3 * draw();
    const double radius = planes.inner_radius(middle);
    double room = 1e9;  // between the middle and the hull's farthest plane in each of many directions
    for (int i = 0; i < 20'000; ++i) {
      const Eigen::Vector3d way = draw().normalized();
      double farthest = -1e9;
      for (const Eigen::Vector3d& point : points) farthest = std::max(farthest, way.dot(point - middle));
      room = std::min(room, farthest);
    }
    EXPECT_LE(radius, room);
    EXPECT_NEAR(radius, room, 0.1);
  }
}

TEST(HullPlanes, of_flat_points_hold_no_sphere) {
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}};
  const HullPlanes planes({points, hull_triangles(points)});
  EXPECT_LE(planes.inner_radius({0.5, 0.4, 0}), 0.0);
}

}  // namespace convex_hull_test
}  // namespace clearway
