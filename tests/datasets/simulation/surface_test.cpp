#include "datasets/simulation/surface.hpp"

#include <gtest/gtest.h>

#include "datasets/simulation/tag_pattern.hpp"
#include "tests/worlds/sample_frames.hpp"

namespace clearway {
namespace surface_test {

/// Signed distance of a point to a shape, by formulas that share nothing with the ray caster.
double distance(const SceneShape& shape, const Eigen::Vector3d& map_point) {
  const Eigen::Vector3d p = shape.map_from_shape.inverse() * map_point;
  const auto of_excess = [](const Eigen::VectorXd& d) {
    return d.cwiseMax(0).norm() + std::min(d.maxCoeff(), 0.0);
  };
  if (const auto* box = std::get_if<BoxShape>(&shape.geometry))
    return of_excess(p.cwiseAbs() - box->size / 2);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape.geometry))
    return of_excess(
        Eigen::Vector2d(std::hypot(p.x(), p.y()) - cylinder->radius, std::abs(p.z()) - cylinder->length / 2));
  return p.norm() - std::get<SphereShape>(shape.geometry).radius;
}

TEST(Surface, RaysStopWhereSphereTracingStops) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1), size(0.05, 1);
  int met = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    SceneShape shape{"s", SphereShape{size(random)}, random_pose(random)};
    if (trial % 3 == 1) shape.geometry = BoxShape{Eigen::Vector3d(size(random), size(random), size(random))};
    if (trial % 3 == 2) shape.geometry = CylinderShape{size(random), size(random)};
    const Surface surface(shape);
    const Eigen::Vector3d origin = 3 * Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
    const Eigen::Vector3d aim = shape.map_from_shape.translation() +
                                0.7 * Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
    if (distance(shape, origin) < 0.01) continue;
    const Eigen::Vector3d direction = (aim - origin).normalized();
    double along = 0;  // walk on by the free distance
    for (int step = 0; step < 2000 && along < 20; ++step)
      along += distance(shape, origin + along * direction);
    Hit hit;
    const bool found = surface.meet(origin, 2 * direction, hit);  // directions need not be unit vectors
    if (found) {
      EXPECT_NEAR(2 * hit.along, along, 1e-3 + (along > 20 ? 1e9 : 0)) << "trial " << trial;
      EXPECT_NEAR(distance(shape, origin + 2 * hit.along * direction), 0, 1e-9);
      EXPECT_LT(hit.normal.dot(direction), 1e-12);
      EXPECT_NEAR(hit.normal.norm(), 1, 1e-9);
      ++met;
    } else {
      EXPECT_GE(along, 20) << "trial " << trial;
    }
  }
  EXPECT_GT(met, 2000);
}

TEST(Surface, NormalsPointTheWayTheDistanceGrows) {
  std::mt19937 random(9);
  const SceneShape shapes[] = {{"b", BoxShape{{0.4, 0.6, 0.8}}, random_pose(random)},
                               {"c", CylinderShape{0.3, 0.7}, random_pose(random)},
                               {"s", SphereShape{0.5}, random_pose(random)}};
  for (const auto& shape : shapes) {
    for (int trial = 0; trial < 300; ++trial) {
      const Eigen::Vector3d origin = 4 * random_pose(random).translation().normalized();
      const Eigen::Vector3d direction = shape.map_from_shape.translation() - origin;
      Hit hit;
      if (!Surface(shape).meet(origin, direction, hit)) continue;
      const Eigen::Vector3d point = origin + hit.along * direction;
      EXPECT_NEAR(distance(shape, point + 1e-4 * hit.normal), 1e-4, 1e-7);
    }
  }
}

TEST(Surface, ATagShowsItsCellsToTheFrontOnly) {
  const auto cells = tag36h11_cells(3);
  std::mt19937 random(1);
  const Eigen::Isometry3d pose = random_pose(random);
  const Surface tag(TagShape{0.8, cells}, pose);
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column) {
      const Eigen::Vector3d cell(0.1 * (column - 4.5), 0.1 * (4.5 - row), 0);
      for (double side : {1.0, -1.0}) {
        const Eigen::Vector3d eye = pose * (cell + Eigen::Vector3d(0.1, 0.2, side));
        Hit hit;
        ASSERT_TRUE(tag.meet(eye, pose * cell - eye, hit));
        EXPECT_NEAR(hit.along, 1, 1e-9);
        const bool white = cells[static_cast<size_t>(10 * row + column)];
        EXPECT_EQ(hit.part, side < 0 ? 2 : white ? 1 : 0);
      }
    }
  }
  Hit outside;
  EXPECT_FALSE(
      tag.meet(pose * Eigen::Vector3d(0.51, 0, 1), pose.linear() * -Eigen::Vector3d::UnitZ(), outside));
}

TEST(TagPattern, HasAWhiteRimABlackBorderAndItsOwnBits) {
  std::set<std::array<bool, 100>> all;
  for (int id = 0; id < 587; ++id) {
    const auto cells = tag36h11_cells(id);
    all.insert(cells);
    for (size_t i = 0; i < 10; ++i)
      for (size_t rim : {i, 90 + i, 10 * i, 10 * i + 9}) EXPECT_TRUE(cells[rim]);
    for (size_t i = 1; i < 9; ++i)
      for (size_t border : {10 + i, 80 + i, 10 * i + 1, 10 * i + 8}) EXPECT_FALSE(cells[border]);
  }
  EXPECT_EQ(all.size(), 587u);
  EXPECT_THROW(tag36h11_cells(587), std::invalid_argument);
  EXPECT_THROW(tag36h11_cells(-1), std::invalid_argument);
}

}  // namespace surface_test
}  // namespace clearway
