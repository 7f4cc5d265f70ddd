// Free configurations, edges and clearances against FCL on every voxel.
#include <gtest/gtest.h>

#include <algorithm>

#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace configuration_space_fcl_test {

constexpr double edge = 0.05;

/// Some obstacle voxels about where the arm moves, and the map that holds them.
struct World {
  std::vector<Eigen::Vector3d> cubes;
  Snapshot map;

  World(const Robot& robot, Random& random, int count) {
    FreeSpaceMap builder({.resolution = edge});
    const int last = std::min(3, static_cast<int>(robot.bodies.size()));  // obstacles about the hand
    for (int i = 0; i < count; ++i) {
      const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
      const Body& body = robot.bodies[robot.bodies.size() - 1 - static_cast<std::size_t>(random.below(last))];
      const Eigen::Vector3d near = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape *
                                   body.shape.support(random.point(1.0));
      const Eigen::Vector3d cube = ((near / edge).array().floor() + 0.5) * edge;
      if (std::find(cubes.begin(), cubes.end(), cube) != cubes.end()) continue;
      occupy(builder, cube);
      cubes.push_back(cube);
    }
    map = builder.snapshot();
  }
};

Policies not_occupied() { return {.critical_by_default = false}; }

/// Configurations at the border between free and blocked as well as anywhere.
std::vector<Configuration> touching_zone(const ConfigurationSpace& space, Random& random, int count) {
  std::vector<Configuration> list;
  while (static_cast<int>(list.size()) < count) {
    Configuration free = random.configuration(space.robot()), blocked = random.configuration(space.robot());
    list.push_back(free);
    if (!space.is_free(free) || space.is_free(blocked)) continue;
    for (int i = 0; i < 10; ++i) {
      const Configuration middle = (free + blocked) / 2;
      (space.is_free(middle) ? free : blocked) = middle;
    }
    list.push_back(free);
    list.push_back(blocked);
  }
  return list;
}

TEST(ConfigurationSpace, IsFreeAgreesWithFclOnEveryVoxelCube) {
  int configurations = 0, free_count = 0, wrongly_free = 0, wrongly_blocked = 0;
  for (const char* name : {"puma560", "arm5", "planar2"}) {
    const Robot robot = load_robot(name);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Random random(seed);
      const World world(robot, random, 40);
      const ConfigurationSpace space(robot, world.map, not_occupied());
      const FclTruth truth(robot, world.cubes, edge);
      for (const Configuration& q : touching_zone(space, random, 900)) {
        const LinkPoses poses = forward_kinematics(robot, q);
        const bool expected = !truth.touches_cube(poses) && !truth.touches_itself(poses);
        const bool free = space.is_free(q);
        ASSERT_EQ(free, space.check(q).is_free());
        ++configurations;
        free_count += expected;
        wrongly_free += free && !expected;
        wrongly_blocked += !free && expected;
      }
    }
  }
  EXPECT_GE(configurations, 20'000);
  EXPECT_GT(free_count, 5'000);
  EXPECT_EQ(wrongly_free, 0);
  EXPECT_LE(wrongly_blocked, free_count / 1000);
}

TEST(ConfigurationSpace, NoAcceptedEdgeTouchesAnythingWhenSampledDensely) {
  int accepted = 0, refused = 0, refused_though_clear = 0;
  const int edges = trials(80, 200);
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    for (std::uint64_t seed = 11; seed <= 14; ++seed) {
      Random random(seed);
      const World world(robot, random, 30);
      const ConfigurationSpace space(robot, world.map, not_occupied());
      const FclTruth truth(robot, world.cubes, edge);
      for (int i = 0; i < edges; ++i) {
        const Configuration from = random.configuration(robot);
        const Configuration to = from + 0.15 * (random.configuration(robot) - from);
        const bool free = space.is_edge_free(from, to);
        ASSERT_EQ(free, space.is_edge_free(to, from));
        (free ? accepted : refused)++;
        const int samples = static_cast<int>(std::ceil((to - from).norm() / (free ? 0.001 : 0.01)));
        bool touched = false;
        for (int k = 0; k <= samples && !touched; ++k) {
          const LinkPoses poses = forward_kinematics(robot, from + (to - from) * k / samples);
          touched = truth.touches_cube(poses) || (k % 10 == 0 && truth.touches_itself(poses));
        }
        ASSERT_FALSE(free && touched) << name << " seed " << seed << " edge " << i;
        refused_though_clear += !free && !touched;
      }
    }
  }
  EXPECT_GE(accepted, edges * 5 / 2);
  EXPECT_GE(refused, edges);
  EXPECT_LE(refused_though_clear, refused / 20);  // grazing ones, undecided or between the coarse samples
}

TEST(ConfigurationSpace, AStepBesideAnObstacleIsAcceptedWhenItKeepsSomeRoomAndNeverWhenItTouches) {
  int accepted = 0, refused = 0, with_room = 0;
  const Robot robot = load_robot("puma560");
  for (std::uint64_t seed = 41; seed <= 44; ++seed) {
    Random random(seed);
    const World world(robot, random, 30);
    const ConfigurationSpace space(robot, world.map, not_occupied());
    const FclTruth truth(robot, world.cubes, edge);
    for (int i = 0; i < 200; ++i) {
      Configuration free = random.configuration(robot), other = random.configuration(robot);
      if (!space.is_free(free) || space.is_free(other)) continue;
      while ((other - free).norm() > 0.01) {  // close to the obstacle, or the robot itself
        const Configuration middle = (free + other) / 2;
        (space.is_free(middle) ? free : other) = middle;
      }
      Configuration to = free;
      for (Eigen::Index j = 0; j < to.size(); ++j) to[j] += 0.02 * (random.below(3) - 1);
      const bool edge_free = space.is_edge_free(free, to);
      (edge_free ? accepted : refused)++;
      bool touched = false;
      double room = 1.0;
      for (int k = 0; k <= 100 && !touched; ++k) {
        const Configuration q = free + (to - free) * k / 100.0;
        const LinkPoses poses = forward_kinematics(robot, q);
        touched = truth.touches_cube(poses) || truth.touches_itself(poses);
        room = std::min(room, space.clearance(q));
      }
      ASSERT_FALSE(edge_free && touched) << "seed " << seed << " edge " << i;
      if (room > 3e-4) {
        ++with_room;
        ASSERT_TRUE(edge_free) << "seed " << seed << " edge " << i;
      }
    }
  }
  EXPECT_GE(accepted, 30);
  EXPECT_GE(refused, 50);
  EXPECT_GE(with_room, 20);
}

TEST(ConfigurationSpace, WhatIsQuicklyFreeIsFreeAndMostFreeEdgesAre) {
  int free = 0, quickly_free = 0;
  for (const char* name : {"puma560", "arm5", "panda"}) {
    const Robot robot = load_robot(name);
    for (std::uint64_t seed = 41; seed <= 43; ++seed) {
      Random random(seed);
      const World world(robot, random, 30);
      const ConfigurationSpace space(robot, world.map, not_occupied());
      for (int i = 0; i < 300; ++i) {
        const Configuration from = random.configuration(robot);
        const Configuration to = from + 0.15 * (random.configuration(robot) - from);
        const bool is_free = space.is_edge_free(from, to), is_quick = space.is_edge_quickly_free(from, to);
        ASSERT_TRUE(is_free || !is_quick) << name << " seed " << seed << " edge " << i;
        free += is_free;
        quickly_free += is_quick;
      }
      Configuration outside = random.configuration(robot);
      outside[0] = robot.joints[0].upper + 0.1;
      EXPECT_FALSE(space.is_edge_quickly_free(random.configuration(robot), outside));
    }
  }
  EXPECT_GE(free, 500);
  EXPECT_GE(quickly_free, free * 6 / 10);
}

TEST(ConfigurationSpace, AClearanceUpToALimitIsTheLesserOfBoth) {
  const Robot robot = load_robot("puma560");
  Random random(51);
  const World world(robot, random, 25);
  const ConfigurationSpace space(robot, world.map, not_occupied());
  int cut = 0, kept = 0;
  for (const Configuration& q : touching_zone(space, random, 300)) {
    const double whole = space.clearance(q), limit = random.between(0.0, 0.1);
    const double limited = space.clearance(q, limit);
    ASSERT_LE(limited, limit);
    if (whole >= limit) {
      EXPECT_EQ(limited, limit);
      ++cut;
    } else {
      EXPECT_LE(limited, whole + 1e-9);  // what is near is looked at closely: by the same shapes
      EXPECT_EQ(limited > 0.0, whole > 0.0);
      ++kept;
    }
  }
  EXPECT_GE(cut, 30);
  EXPECT_GE(kept, 100);
}

TEST(ConfigurationSpace, ClearanceIsNeverAboveFclsDistanceAndCloseToItNearObstacles) {
  const Robot robot = load_robot("puma560");
  double worst_over = 0.0, worst_under = 0.0;
  for (std::uint64_t seed = 21; seed <= 24; ++seed) {
    Random random(seed);
    const World world(robot, random, 25);
    const ConfigurationSpace space(robot, world.map, not_occupied());
    const FclTruth truth(robot, world.cubes, edge);
    for (int i = 0; i < 250; ++i) {
      const Configuration q = random.configuration(robot);
      const LinkPoses poses = forward_kinematics(robot, q);
      const double expected = std::min(truth.cube_distance(poses, 0.5), truth.self_distance(poses, 0.5));
      const double clearance = space.clearance(q);
      worst_over = std::max(worst_over, clearance - expected);
      if (expected < edge) worst_under = std::max(worst_under, expected - clearance);
    }
  }
  EXPECT_LT(worst_over, 1e-6);
  EXPECT_LT(worst_under, 1e-5);
}

}  // namespace configuration_space_fcl_test
}  // namespace clearway
