#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace proximity_test {

constexpr double edge = 0.05;

TEST(ProximityConstraints, GradientIsTheNumericRateOfApproachToALoneVoxel) {
  for (const char* name : {"puma560", "arm5", "planar2", "point"}) {
    const Robot robot = load_robot(name);
    Random random(1);
    int constraints_seen = 0;
    for (int i = 0; i < 60; ++i) {
      Configuration q = random.configuration(robot);
      const LinkPoses poses = forward_kinematics(robot, q);
      const Body& body = robot.bodies.back();
      const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
      const Eigen::Vector3d way = random.point(1.0).normalized();
      const Eigen::Vector3d beside = pose * body.shape.support(pose.linear().transpose() * way) + 0.08 * way;
      const Eigen::Vector3d cube = ((beside / edge).array().floor() + 0.5) * edge;
      FreeSpaceMap builder({.resolution = edge});
      occupy(builder, cube);
      const ConfigurationSpace space(robot, builder.snapshot(), {.critical_by_default = false});
      const FclTruth truth(robot, {cube}, edge);
      for (const ProximityConstraint& constraint : space.proximity_constraints(q, 0.2)) {
        const auto index = static_cast<std::size_t>(constraint.body);
        const auto distance_at = [&](const Configuration& at) {
          return distance_to_cube(robot.bodies[index].shape,
                                  truth.place(index, forward_kinematics(robot, at)), cube, edge)
              .upper;
        };
        const double here = truth.body_distance(index, truth.place(index, poses), cube);
        if (here < 1e-3 || std::abs(constraint.distance - here) > 1e-5) continue;  // self pairs, touching
        ++constraints_seen;
        for (Eigen::Index j = 0; j < q.size(); ++j) {
          Configuration up = q, down = q;
          up[j] += 1e-6;
          down[j] -= 1e-6;
          EXPECT_NEAR(constraint.gradient[j], -(distance_at(up) - distance_at(down)) / 2e-6, 2e-3)
              << name << " joint " << j;
        }
      }
    }
    EXPECT_GT(constraints_seen, 20) << name;
  }
}

TEST(ProximityConstraints, TheNearestPairOfEveryBodyHasAConstraintAndNoConstraintIsTooFarOrTooLong) {
  const Robot robot = load_robot("puma560");
  Random random(2);
  FreeSpaceMap builder({.resolution = edge});
  std::vector<Eigen::Vector3d> cubes;
  for (int i = 0; i < 30; ++i) {
    cubes.push_back(
        ((tip_pose(robot, random.configuration(robot)).translation() / edge).array().floor() + 0.5) * edge);
    occupy(builder, cubes.back());
  }
  const ConfigurationSpace space(robot, builder.snapshot(), {.critical_by_default = false});
  const FclTruth truth(robot, cubes, edge);
  int near = 0;
  for (int i = 0; i < 300; ++i) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    const auto constraints = space.proximity_constraints(q, 0.15);
    double least_constraint = 0.15;
    for (const ProximityConstraint& constraint : constraints) {
      least_constraint = std::min(least_constraint, constraint.distance);
      EXPECT_LT(constraint.distance, 0.15);
      EXPECT_NEAR(constraint.normal.norm(), 1.0, 1e-9);
    }
    const double truth_distance =
        std::min(truth.cube_distance(poses, 0.15), truth.self_distance(poses, 0.15));
    EXPECT_NEAR(least_constraint, truth_distance, 1e-5);
    near += truth_distance < 0.15;
    const auto again = space.proximity_constraints(q, 0.15);
    ASSERT_EQ(constraints.size(), again.size());
    for (std::size_t k = 0; k < constraints.size(); ++k)
      EXPECT_EQ(constraints[k].gradient, again[k].gradient);
  }
  EXPECT_GT(near, 30);
}

TEST(ProximityConstraints, ALongBodyHasAConstraintAtEachEndForTheSameWall) {
  const Robot robot = load_robot("planar2");  // capsules of 1 m, radius 0.05, along x at zero
  FreeSpaceMap builder({.resolution = edge});
  for (int x = -5; x < 45; ++x) occupy(builder, {(x + 0.5) * edge, 0.225, 0.025});  // a wall at y = 0.2
  const ConfigurationSpace space(robot, builder.snapshot(), {.critical_by_default = false});
  double first = 10.0,
         last = -10.0;  // by their gradient: a constraint at x turns the first joint's wall by x
  for (const ProximityConstraint& constraint : space.proximity_constraints(Eigen::Vector2d(0.0, 0.0), 0.3)) {
    if (constraint.body != 0 || constraint.distance < 0.1) continue;
    first = std::min(first, std::abs(constraint.gradient[0]));
    last = std::max(last, std::abs(constraint.gradient[0]));
  }
  EXPECT_LT(first, 0.35);
  EXPECT_GT(last, 0.65);
}

TEST(ProximityConstraints, ADiscInOneLayerOfKnownSpaceSeesItsWallsAndNotItsFloor) {
  const Robot robot = load_robot("point");
  FreeSpaceMap builder({.resolution = edge});
  const int volume = builder.add_volume("floor", {"base"});
  // One layer of free voxels around z = 0.025: small spheres that hold one voxel each.
  for (int x = -10; x < 10; ++x) {
    for (int y = -10; y < 10; ++y) {
      builder.paint(volume, {(Eigen::Vector3d(x, y, 0).array() + 0.5) * edge, 0.87 * edge});
    }
  }
  Robot raised = robot;
  raised.map_from_base.translation().z() = 0.025;
  const ConfigurationSpace space(raised, builder.snapshot());
  EXPECT_TRUE(space.is_free(Eigen::Vector2d(0.0, 0.0)));
  EXPECT_TRUE(space.is_edge_free(Eigen::Vector2d(-0.25, 0.0), Eigen::Vector2d(0.25, 0.1)));
  EXPECT_TRUE(space.proximity_constraints(Eigen::Vector2d(0.0, 0.0), 0.2).empty());  // walls are 0.3 m away
  const auto constraints =
      space.proximity_constraints(Eigen::Vector2d(0.2, 0.0), 0.2);  // the wall at x = 0.5 is 0.1 m away
  double toward_wall = 0.0;
  for (const ProximityConstraint& constraint : constraints) {
    EXPECT_GT(constraint.gradient.norm(), 0.0);
    if (constraint.gradient[0] > 0.99) toward_wall = constraint.distance;
  }
  EXPECT_NEAR(toward_wall, 0.1, 1e-6);
}

TEST(ProximityConstraints, BothWallsOfACorridorHaveConstraints) {
  const Robot robot = load_robot("point");
  FreeSpaceMap builder({.resolution = edge});
  for (int x = -10; x < 10; ++x) {
    for (double y : {-0.325, 0.325}) occupy(builder, {(x + 0.5) * edge, y, 0.025});
  }
  const ConfigurationSpace space(robot, builder.snapshot(), {.critical_by_default = false});
  const auto constraints = space.proximity_constraints(Eigen::Vector2d(0.0, 0.02), 0.2);
  const auto has = [&](double gradient_y, double distance) {
    return std::any_of(constraints.begin(), constraints.end(), [&](const ProximityConstraint& constraint) {
      return std::abs(constraint.gradient[1] - gradient_y) < 0.01 &&
             std::abs(constraint.distance - distance) < 1e-3;
    });
  };
  EXPECT_TRUE(has(1.0, 0.08));
  EXPECT_TRUE(has(-1.0, 0.12));
}

}  // namespace proximity_test
}  // namespace clearway
