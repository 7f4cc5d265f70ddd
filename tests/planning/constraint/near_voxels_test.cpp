#include "planning/constraint/near_voxels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace sphere_cubes_test {

constexpr double edge = 0.03, reach = 0.12, radius = 0.05;

double distance_to(const Eigen::Vector3d& cube, const Eigen::Vector3d& point) {
  return ((point - cube).cwiseAbs().array() - edge / 2).max(0.0).matrix().norm();
}

std::shared_ptr<const BlockedSpace> rubble(Random& random, double field_ends) {
  FreeSpaceMap map({.resolution = edge});
  for (int i = 0; i < 150; ++i) occupy(map, ((random.point(0.5) / edge).array().floor() + 0.5) * edge);
  return map.snapshot().blocked_space(
      {Policy::not_occupied}, {Eigen::Vector3d::Constant(-0.9), Eigen::Vector3d::Constant(0.9)}, field_ends);
}

/// Bodies of two spheres each; the second may not get below the plane z = 0.
struct TwoBodies {
  std::vector<NearSphere> spheres;
  TwoBodies(Random& random, const BlockedSpace& space) {
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d center = random.point(0.6);
      spheres.push_back({i / 2, space.clearance(center) - radius < 0.08, radius, reach, center});
    }
  }
};

const Eigen::AlignedBox3d anywhere(Eigen::Vector3d::Constant(-2.0), Eigen::Vector3d::Constant(2.0));
const Eigen::AlignedBox3d upper_half(Eigen::Vector3d(-2.0, -2.0, 0.001), Eigen::Vector3d::Constant(2.0));

TEST(NearVoxels, AreBlockedOnceEachWithinReachAndTheNearestIsAmongThem) {
  Random random(6);
  const auto space = rubble(random, 0.4);
  NearVoxels cubes(*space);
  cubes.add(anywhere, 2);
  cubes.add(upper_half, 2);
  int near = 0, farther = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const TwoBodies bodies(random, *space);
    cubes.look(bodies.spheres);
    for (const std::size_t body : {0U, 1U}) {
      const std::span<const NearVoxel> found = cubes.gather(bodies.spheres, 2 * body, 2 * body + 2);
      std::set<std::array<double, 3>> keys;
      std::array<double, 2> least{reach + radius, reach + radius};
      for (const NearVoxel& cube : found) {
        EXPECT_TRUE(keys.insert({cube.center.x(), cube.center.y(), cube.center.z()}).second);
        EXPECT_TRUE(space->is_blocked(cube.center));
        EXPECT_GE(cube.behind, 0.0);
        EXPECT_LT(distance_to(cube.center, cube.towards), reach + radius);
        EXPECT_TRUE(body == 0 || cube.center.z() + edge / 2 > 0.0);
        for (const std::size_t i : {0U, 1U})
          least[i] = std::min(least[i], distance_to(cube.center, bodies.spheres[2 * body + i].center));
      }
      for (const std::size_t i : {0U, 1U}) {
        const NearSphere& sphere = bodies.spheres[2 * body + i];
        double truth = reach + radius;
        space->visit_blocked({sphere.center.array() - truth, sphere.center.array() + truth},
                             [&](const Eigen::Vector3d& cube) {
                               if (body == 0 || cube.z() > 0.0)
                                 truth = std::min(truth, distance_to(cube, sphere.center));
                               return true;
                             });
        EXPECT_GE(least[i], truth - 1e-12);
        if (!sphere.is_close || truth >= reach + radius) continue;
        ++near;
        farther += least[i] > truth + 1e-9;
        EXPECT_LE(least[i], truth + 0.5 * edge);
      }
    }
  }
  EXPECT_GT(near, 1000);
  EXPECT_LT(farther, near / 50);
}

TEST(NearVoxels, AreAllThatTheSphereReachesWhereTheFieldEndsTooSoon) {
  Random random(7);
  const auto space = rubble(random, 0.1);
  NearVoxels cubes(*space);
  cubes.add(anywhere, 1);
  std::size_t total = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const NearSphere sphere{0, false, radius, reach, random.point(0.5)};
    cubes.look({&sphere, 1});
    const std::span<const NearVoxel> found = cubes.gather({&sphere, 1}, 0, 1);
    std::size_t expected = 0;
    space->visit_surface({sphere.center.array() - reach - radius, sphere.center.array() + reach + radius},
                         [&](const Eigen::Vector3d& cube) {
                           expected += distance_to(cube, sphere.center) < reach + radius ? 1 : 0;
                           return true;
                         });
    EXPECT_EQ(found.size(), expected);
    total += expected;
  }
  EXPECT_GT(total, 300U);
}

}  // namespace sphere_cubes_test
}  // namespace clearway
