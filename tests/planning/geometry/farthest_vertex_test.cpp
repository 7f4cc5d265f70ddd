#include "planning/geometry/farthest_vertex.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace farthest_vertex_test {

/// The first of the points at which `number_at` is largest.
template <class NumberAt>
std::size_t one_by_one(const std::vector<Eigen::Vector3d>& points, const NumberAt& number_at) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (number_at(points[i]) > number_at(points[best])) best = i;
  }
  return best;
}

TEST(FarthestVertex, IsTheFirstOfTheFarthest) {
  Random random(1);
  for (std::size_t count = 1; count < 70; ++count) {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back(random.point(1.0));
      if (i % 3 == 1) points.back() = points[i / 2];  // some twice
      if (i % 7 == 2) points.back().z() = 1.0;        // some equally far
    }
    for (int round = 0; round < 50; ++round) {
      const Eigen::Vector3d direction = round == 0   ? Eigen::Vector3d::Zero()
                                        : round == 1 ? Eigen::Vector3d::UnitZ()
                                                     : random.point(1.0);
      const auto along = [&](const Eigen::Vector3d& point) { return direction.dot(point); };
      const auto away = [&](const Eigen::Vector3d& point) { return (point - direction).squaredNorm(); };
      ASSERT_EQ(farthest_vertex(points, direction), one_by_one(points, along)) << count;
      ASSERT_EQ(farthest_from(points, direction), one_by_one(points, away)) << count;
    }
  }
}

TEST(FarthestVertex, TheLargestNormIsThatOfSomePoint) {
  Random random(2);
  for (std::size_t count = 1; count < 40; ++count) {
    std::vector<Eigen::Vector3d> points;
    double largest = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back(random.point(1.0));
      largest = std::max(largest, points.back().squaredNorm());
    }
    EXPECT_EQ(largest_squared_norm(points), largest);
  }
}

}  // namespace farthest_vertex_test
}  // namespace clearway
