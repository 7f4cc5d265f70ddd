#include "planning/routes/sphere_clusters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace sphere_clusters_test {

/// Spheres of many sizes along a winding stroke, as a hand paints them.
std::vector<Sphere> stroke(Random& random, int count) {
  std::vector<Sphere> spheres;
  Eigen::Vector3d at = Eigen::Vector3d::Zero(), way = Eigen::Vector3d::UnitX();
  for (int i = 0; i < count; ++i) {
    way = (way + 0.1 * random.point(1.0)).normalized();
    at += 0.003 * way;
    spheres.push_back({at, i % 50 == 0 ? 0.3 : random.between(0.01, 0.1)});
  }
  return spheres;
}

auto key(const Sphere& sphere) {
  return std::make_tuple(sphere.center.x(), sphere.center.y(), sphere.center.z(), sphere.radius);
}

TEST(SphereClusters, FewSpheresAreAClusterEachInTheirOrder) {
  Random random(41);
  const std::vector<Sphere> spheres = stroke(random, 100);
  const SphereClusters clusters(spheres, 100, nullptr);
  ASSERT_EQ(clusters.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    ASSERT_EQ(clusters.spheres(i).size(), 1U);
    EXPECT_EQ(key(clusters.sphere(i)), key(spheres[i]));
    EXPECT_EQ(clusters.reach(i), spheres[i].radius);
  }
}

TEST(SphereClusters, OfManyEachSphereIsInOneClusterWhoseSpheresOverlap) {
  Random random(42);
  for (const int count : {2000, 20000}) {
    std::vector<Sphere> spheres = stroke(random, count);
    const SphereClusters clusters(spheres, 500, nullptr);
    EXPECT_LT(clusters.size(), spheres.size() / 2);
    std::vector<std::tuple<double, double, double, double>> given, found;
    for (const Sphere& sphere : spheres) given.push_back(key(sphere));
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      for (const Sphere& a : clusters.spheres(i)) {
        found.push_back(key(a));
        EXPECT_LE(a.radius, clusters.sphere(i).radius);
        EXPECT_LE((a.center - clusters.sphere(i).center).norm() + a.radius, clusters.reach(i));
        for (const Sphere& b : clusters.spheres(i))
          ASSERT_LT((a.center - b.center).norm(), a.radius + b.radius);
      }
    }
    std::sort(given.begin(), given.end());
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(given == found);
  }
}

TEST(SphereClusters, VisitsThePairsThatMayOverlapOnceInBothOrders) {
  Random random(43);
  for (const int count : {300, 3000}) {
    std::vector<Sphere> spheres = stroke(random, count);
    spheres.push_back({{0.5, 0.5, 0.5}, 2.0});  // one that reaches all over the small ones
    const SphereClusters clusters(spheres, 400, nullptr);
    std::map<std::pair<std::size_t, std::size_t>, int> visits;
    clusters.visit_near_pairs([&](std::size_t i, std::size_t j) { ++visits[{i, j}]; }, nullptr);
    std::size_t expected = 0;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      for (std::size_t j = 0; j < clusters.size(); ++j) {
        const double apart = (clusters.sphere(i).center - clusters.sphere(j).center).norm();
        if (i == j || apart > clusters.reach(i) + clusters.reach(j)) continue;
        ++expected;
        EXPECT_EQ((visits[{i, j}]), 1) << i << " " << j;
      }
    }
    EXPECT_EQ(visits.size(), expected);
  }
}

TEST(SphereClusters, OnceStoppedThereAreNone) {
  Random random(44);
  EXPECT_EQ(SphereClusters(stroke(random, 3000), 500, [] { return true; }).size(), 0U);
}

}  // namespace sphere_clusters_test
}  // namespace clearway
