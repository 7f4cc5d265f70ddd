#include "planning/beam/lattice_checks.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/trials.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace lattice_checks_test {

struct Counts {
  int free = 0, blocked = 0, free_edges = 0, blocked_edges = 0;
};

/// Walks from free node to free neighbour and asks for its neighbours on the way, both ways.
void walk(const ConfigurationSpace& space, const Configuration& start, double step, Random& random,
          Counts& counts) {
  const PathCost cost(space.robot());
  BeamOptions options;
  options.step = {step};
  const Lattice lattice({space, cost, start, start}, options);
  LatticeChecks checks(space, lattice);
  LatticeIndex at(space.robot().dof(), 0);
  KnownClearances known = checks.measure(at);
  for (int i = 0; i < 120; ++i) {
    const Configuration from = lattice.configuration(at);
    LatticeIndex next = at;
    for (int& index : next) index += random.below(3) - 1;
    if (!lattice.keeps_limits(next)) continue;
    const Configuration to = lattice.configuration(next);
    KnownClearances known_next;
    const bool free = checks.is_free(next, at, known, known_next);
    ASSERT_EQ(free, space.is_free(to)) << space.robot().name << " step " << i;
    (free ? counts.free : counts.blocked)++;
    if (!free) continue;
    const bool edge_free = checks.is_edge_free(at, known, next, known_next);
    ASSERT_EQ(edge_free, space.is_edge_free(from, to)) << space.robot().name << " step " << i;
    (edge_free ? counts.free_edges : counts.blocked_edges)++;
    if (random.below(3) != 0) at = next, known = known_next;
  }
}

Configuration configuration(const Robot& robot, Random& random) {
  if (robot.dof() == 2) return random.point(2.0).head<2>();
  return random.configuration(robot);
}

TEST(LatticeChecks, AnswersAsTheConfigurationSpaceDoesOnAnyWalkAmongObstacles) {
  const int walks = trials(24, 60);
  Random random(5);
  for (const char* name : {"puma560", "panda", "arm5", "point"}) {
    const Robot robot = load_robot(name);
    Counts counts;
    for (int scene = 0; scene < 6; ++scene) {
      VoxelScene voxels{0.04, {}, {}, robot.critical_parts};
      const double size = robot.dof() == 2 ? 2.0 : 0.9;
      for (int i = 0; i < 40; ++i) {
        Eigen::Vector3d corner = random.point(size);
        const double edge = random.between(0.02, 0.12);
        if (robot.dof() == 2) corner.z() = -edge / 2;
        voxels.occupied.emplace_back(corner, corner + Eigen::Vector3d::Constant(edge));
      }
      Policies policies;
      if (scene % 2 == 0) {
        policies.critical_by_default = false;
      } else {  // the hand in painted spheres about where it is
        for (int i = 0; i < 400; ++i)
          voxels.painted.push_back({random.point(size), random.between(0.2, 0.45)});
      }
      SpaceOptions options;
      options.padding = scene >= 4 ? 0.01 : 0.0;
      const ConfigurationSpace space(robot, voxels.snapshot(), policies, options);
      for (int i = 0; i < walks; ++i) {
        Configuration start = configuration(robot, random), other = configuration(robot, random);
        if (!space.is_free(start)) continue;
        while (!space.is_free(other) && (other - start).norm() > 0.01) {  // close to what blocks
          const Configuration middle = (start + other) / 2;
          (space.is_free(middle) ? start : other) = middle;
        }
        walk(space, start, i % 3 == 0 ? 0.0087 : i % 3 == 1 ? 0.03 : 1e-5, random, counts);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
    EXPECT_GT(counts.free_edges, 8 * walks) << name;
    EXPECT_GT(counts.blocked, walks) << name;
    EXPECT_GT(counts.blocked_edges, walks / 12) << name;
  }
}

TEST(LatticeChecks, WhatItKnowsOfAClearanceIsNeverTooMuch) {
  Random random(6);
  const Robot robot = load_robot("puma560");
  VoxelScene voxels{0.05, {}, {}, {}};
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d corner = random.point(1.0);
    voxels.occupied.emplace_back(corner, corner + Eigen::Vector3d::Constant(0.1));
  }
  Policies policies;
  policies.critical_by_default = false;
  const ConfigurationSpace space(robot, voxels.snapshot(), policies);
  const PathCost cost(robot);
  int nodes = 0;
  for (int i = 0; i < 200; ++i) {
    const Configuration start = random.configuration(robot);
    if (!space.is_free(start)) continue;
    const Lattice lattice({space, cost, start, start}, BeamOptions{});
    LatticeChecks checks(space, lattice);
    LatticeIndex at(6, 0);
    KnownClearances known = checks.measure(at);
    for (int k = 0; k < 40; ++k) {
      LatticeIndex next = at;
      for (int& index : next) index += random.below(3) - 1;
      KnownClearances known_next;
      if (!lattice.keeps_limits(next) || !checks.is_free(next, at, known, known_next)) continue;
      at = next, known = known_next;
      ++nodes;
      // No body is nearer than the least of them: padded by it, the robot is still free.
      double least = 1.0;
      for (const double bound : known.at_least) least = std::min(least, bound);
      if (least < 1e-3) continue;
      SpaceOptions padded;
      padded.padding = 0.999 * least;
      const ConfigurationSpace wide(robot, space.map(), policies, padded);
      ASSERT_TRUE(wide.is_free(lattice.configuration(at))) << least;
      k += 8;  // a new space each time is slow
    }
  }
  EXPECT_GT(nodes, 200);
}

}  // namespace lattice_checks_test
}  // namespace clearway
