#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

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

/// A body that floats: three slides, then three turns.
Robot floating(const Shape& shape) {
  Robot robot;
  robot.name = "floating";
  robot.links.resize(7);
  robot.links[0].name = "base";
  for (int j = 0; j < 6; ++j) {
    Joint& joint = robot.joints.emplace_back();
    joint.name = "j" + std::to_string(j);
    joint.kind = j < 3 ? JointKind::prismatic : JointKind::revolute;
    joint.axis = Eigen::Vector3d::Unit(j % 3);
    joint.lower = j < 3 ? -1.0 : -3.0;
    joint.upper = -joint.lower;
    Link& link = robot.links[static_cast<std::size_t>(j) + 1];
    link.name = "l" + std::to_string(j);
    link.parent = link.joint = j;
  }
  robot.bodies.resize(1);
  robot.bodies[0] = {"body", 6, Eigen::Isometry3d::Identity(), shape, shape.sphere_cover()};
  robot.tip_link = 6;
  return robot;
}

struct Expected {
  double distance;
  std::vector<Eigen::Vector3d> normals, points;  ///< of several cubes that overlap any may stand
};

/// Of the voxels that lie beside the same part of the body's length and the same way, the nearest.
std::map<std::pair<int, int>, Expected> nearest_of_each(const Shape& shape, const Eigen::Isometry3d& pose,
                                                        const std::vector<Eigen::Vector3d>& cubes,
                                                        double reach) {
  const MedialSegment medial = shape.medial_segment();
  int parts = 1;
  while (parts < 4 && medial.half_extent > parts * medial.width) ++parts;
  std::map<std::pair<int, int>, Expected> nearest;
  for (const Eigen::Vector3d& cube : cubes) {
    const DistanceBounds bounds = distance_to_cube(shape, pose, cube, edge);
    if (bounds.lower >= reach) continue;
    const Eigen::Vector3d local = pose.inverse() * cube;
    const double place = std::max(-medial.half_length, std::min(medial.half_length, medial.axis.dot(local)));
    int part = 0;
    while (part + 1 < parts && place >= medial.half_length * (2.0 * (part + 1) / parts - 1.0)) ++part;
    Eigen::Vector3d way = shape.offset_to(local);
    if (way.norm() == 0.0) way = local - place * medial.axis;
    way = pose.linear() * way.normalized();
    int axis = 0;
    for (int i = 1; i < 3; ++i)
      if (std::abs(way[i]) > std::abs(way[axis])) axis = i;
    const bool is_overlap = bounds.lower <= 0.0;
    const auto known = nearest.try_emplace({part, way[axis] < 0.0 ? -1 - axis : 1 + axis},
                                           Expected{std::numeric_limits<double>::infinity(), {}, {}});
    Expected& slot = known.first->second;
    if (bounds.lower < slot.distance) slot = {bounds.lower, {}, {}};
    if (bounds.lower > slot.distance) continue;
    slot.normals.push_back(is_overlap ? way : bounds.direction);
    slot.points.push_back(is_overlap ? cube : bounds.point_a);
  }
  return nearest;
}

TEST(ProximityConstraints, AreTheNearestVoxelsOfEachPartOfABodysLengthOnEachSideByBruteForce) {
  Random random(8);
  int constraints_seen = 0, overlapping = 0;
  std::set<int> ways;
  for (const Shape& shape : {Shape::sphere(0.1), Shape::capsule(0.04, 0.5), Shape::cylinder(0.05, 0.2),
                             Shape::box({0.3, 0.1, 0.08}), Shape::box({0.08, 0.4, 0.09})}) {
    const Robot robot = floating(shape);
    for (int trial = 0; trial < 12; ++trial) {
      FreeSpaceMap builder({.resolution = edge});
      std::vector<Eigen::Vector3d> cubes;
      for (int i = 0; i < 40; ++i) {
        const Eigen::Vector3d cube = ((random.point(0.4) / edge).array().floor() + 0.5) * edge;
        if (std::find(cubes.begin(), cubes.end(), cube) != cubes.end()) continue;
        cubes.push_back(cube);
        occupy(builder, cube);
      }
      const double padding = trial % 2 == 0 ? 0.0 : 0.02, influence = random.between(0.05, 0.2);
      const ConfigurationSpace space(robot, builder.snapshot(), {.critical_by_default = false},
                                     {.padding = padding});
      Configuration q = random.configuration(robot);
      q.head<3>() *= 0.2;
      const Eigen::Isometry3d pose = forward_kinematics(robot, q)[6];
      const auto expected = nearest_of_each(shape, pose, cubes, influence + padding);
      const auto constraints = space.proximity_constraints(q, influence);
      ASSERT_EQ(constraints.size(), expected.size()) << trial;
      for (const auto& [slot, nearest] : expected) {
        const auto is_it = [&](const ProximityConstraint& constraint) {
          for (std::size_t i = 0; i < nearest.normals.size(); ++i)
            if ((constraint.normal - nearest.normals[i]).norm() < 1e-3 &&
                std::abs(constraint.distance - (nearest.distance - padding)) < 1e-6 &&
                (constraint.point - nearest.points[i]).dot(nearest.normals[i]) < 1e-4)
              return true;
          return false;
        };
        EXPECT_TRUE(std::any_of(constraints.begin(), constraints.end(), is_it))
            << trial << ": part " << slot.first << " way " << slot.second;
        ways.insert(slot.second);
        overlapping += nearest.distance <= 0.0;
      }
      for (const ProximityConstraint& constraint : constraints) {
        ++constraints_seen;
        EXPECT_EQ(constraint.body, 0);
        const Eigen::Vector3d local = pose.inverse() * constraint.point;
        for (Eigen::Index j = 0; j < 6; ++j) {
          Configuration up = q, down = q;
          up[j] += 1e-4, down[j] -= 1e-4;
          const Eigen::Vector3d moved =
              (forward_kinematics(robot, up)[6] * local - forward_kinematics(robot, down)[6] * local) / 2e-4;
          EXPECT_NEAR(constraint.gradient[j], constraint.normal.dot(moved), 2e-5);
        }
      }
    }
  }
  EXPECT_GT(constraints_seen, 200);
  EXPECT_GT(overlapping, 30);
  EXPECT_EQ(ways.size(), 6U);
}

TEST(ProximityConstraints, OfAConfigurationThatIsNoneAreRefused) {
  const Robot robot = load_robot("planar2");
  const ConfigurationSpace space(robot, Snapshot(), {.critical_by_default = false});
  EXPECT_NO_THROW(space.proximity_constraints(Eigen::Vector2d(0.1, 0.2), 0.1));
  EXPECT_THROW(space.proximity_constraints(Eigen::Vector3d::Zero(), 0.1), std::invalid_argument);
  EXPECT_THROW(space.proximity_constraints(Eigen::Vector2d(0.0, NAN), 0.1), std::invalid_argument);
  EXPECT_THROW(space.proximity_constraints(Eigen::Vector2d(0.0, 0.0), NAN), std::invalid_argument);
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
