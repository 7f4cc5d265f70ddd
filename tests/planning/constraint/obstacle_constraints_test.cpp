#include "planning/constraint/obstacle_constraints.hpp"

#include <gtest/gtest.h>

#include "planning/robot/reach.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace obstacle_rows_test {

Shape random_shape(Random& random) {
  switch (random.below(4)) {
    case 0:
      return Shape::sphere(random.between(0.03, 0.2));
    case 1:
      return Shape::capsule(random.between(0.03, 0.1), random.between(0.1, 0.5));
    case 2:
      return Shape::cylinder(random.between(0.03, 0.1), random.between(0.1, 0.5));
    default:
      return Shape::box({random.between(0.05, 0.3), random.between(0.05, 0.3), random.between(0.05, 0.3)});
  }
}

/// Shapes about where the arm's tip gets, some of them moving.
std::vector<PlacedShape> random_shapes(const Robot& robot, Random& random, int count) {
  std::vector<PlacedShape> shapes;
  for (int i = 0; i < count; ++i) {
    PlacedShape shape{random_shape(random), random.pose(0.2), random.point(1.0), random.point(2.0)};
    shape.pose.translation() += tip_pose(robot, random.configuration(robot)).translation();
    shapes.push_back(shape);
  }
  return shapes;
}

double true_distance(const Robot& robot, int body, const LinkPoses& poses, const PlacedShape& shape) {
  const Body& mine = robot.bodies[static_cast<std::size_t>(body)];
  const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(mine.link)] * mine.link_from_shape;
  const auto a = fcl_geometry(mine.shape), b = fcl_geometry(shape.shape);
  if (fcl_collide(a.get(), pose, b.get(), shape.pose)) return 0.0;
  return fcl_distance(a.get(), pose, b.get(), shape.pose);
}

/// The shape `dt` seconds later.
PlacedShape moved_on(PlacedShape shape, double dt) {
  const double angle = dt * shape.angular_velocity.norm();
  shape.pose.translation() += dt * shape.linear_velocity;
  shape.pose.linear() =
      Eigen::AngleAxisd(angle, shape.angular_velocity.stableNormalized()) * shape.pose.linear();
  return shape;
}

/// Distance of a body from a shape, `dt` seconds on with joint velocities `speed`.
double distance_after(const Robot& robot, int index, const PlacedShape& shape, const Configuration& q,
                      const Eigen::VectorXd& speed, double dt) {
  const Body& body = robot.bodies[static_cast<std::size_t>(index)];
  const LinkPoses poses = forward_kinematics(robot, q + dt * speed);
  const PlacedShape later = moved_on(shape, dt);
  return distance(body.shape, poses[static_cast<std::size_t>(body.link)] * body.link_from_shape, later.shape,
                  later.pose)
      .upper;
}

TEST(ObstacleConstraints, EveryNearPairHasAConstraintWithTheDistanceThatFclFinds) {
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    const ObstacleConstraints near(robot);
    Random random(1);
    int seen = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const Configuration q = random.configuration(robot);
      const LinkPoses poses = forward_kinematics(robot, q);
      const std::vector<PlacedShape> shapes = random_shapes(robot, random, 5);
      std::vector<ObstacleConstraint> constraints;
      near.append(poses, shapes, 0.25, constraints);
      std::size_t next = 0;
      for (int s = 0; s < 5; ++s) {
        for (int b = 0; b < static_cast<int>(robot.bodies.size()); ++b) {
          if (!is_moved(robot, robot.bodies[static_cast<std::size_t>(b)].link)) continue;
          const double distance = true_distance(robot, b, poses, shapes[static_cast<std::size_t>(s)]);
          if (next < constraints.size() && constraints[next].obstacle == s && constraints[next].body == b) {
            const ObstacleConstraint& constraint = constraints[next++];
            EXPECT_NEAR(constraint.distance, distance, 1e-5) << name;
            EXPECT_LE(constraint.distance, distance + 1e-7) << name;
            EXPECT_NEAR(constraint.normal.norm(), 1.0, 1e-9);
            ++seen;
          } else if (distance < 0.25 - 1e-5) {  // on the axis of the joints: none changes it
            for (Eigen::Index j = 0; j < q.size(); ++j) {
              const Eigen::VectorXd speed = Eigen::VectorXd::Unit(q.size(), j);
              const PlacedShape still{shapes[static_cast<std::size_t>(s)].shape,
                                      shapes[static_cast<std::size_t>(s)].pose};
              EXPECT_NEAR(distance_after(robot, b, still, q, speed, 1e-5),
                          distance_after(robot, b, still, q, speed, -1e-5), 2e-8)
                  << name << " body " << b;
            }
          }
        }
      }
      EXPECT_EQ(next, constraints.size());
    }
    EXPECT_GT(seen, 100) << name;
  }
}

TEST(ObstacleConstraints, GradientAndApproachSpeedAreTheNumericRateOfApproach) {
  const Robot robot = load_robot("puma560");
  const ObstacleConstraints near(robot);
  Random random(2);
  constexpr double h = 1e-6;
  int seen = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Configuration q = random.configuration(robot);
    const Eigen::VectorXd speed = Eigen::VectorXd::NullaryExpr(6, [&] { return random.between(-1.0, 1.0); });
    const std::vector<PlacedShape> shapes = random_shapes(robot, random, 5);
    std::vector<ObstacleConstraint> constraints;
    near.append(forward_kinematics(robot, q), shapes, 0.25, constraints);
    for (const ObstacleConstraint& constraint : constraints) {
      const PlacedShape& shape = shapes[static_cast<std::size_t>(constraint.obstacle)];
      const double before = distance_after(robot, constraint.body, shape, q, speed, -h);
      const double now = distance_after(robot, constraint.body, shape, q, speed, 0.0);
      const double after = distance_after(robot, constraint.body, shape, q, speed, h);
      // Touching, or where the nearest point jumps along an edge: no rate to compare with.
      if (now < 1e-3 || std::abs(after - 2.0 * now + before) > 1e-4 * h) continue;
      ++seen;
      EXPECT_NEAR(constraint.gradient.dot(speed) + constraint.approach_speed, (before - after) / (2.0 * h),
                  2e-3);
    }
  }
  EXPECT_GT(seen, 100);
}

TEST(ObstacleConstraints, BodiesOfAnotherRobotMoveAsItsJointsMoveThem) {
  const Robot robot = load_robot("puma560");
  Random random(3);
  constexpr double h = 1e-6;
  for (int trial = 0; trial < 20; ++trial) {
    const Configuration q = random.configuration(robot);
    const Eigen::VectorXd speed = Eigen::VectorXd::NullaryExpr(6, [&] { return random.between(-1.0, 1.0); });
    std::vector<PlacedShape> shapes = placed_bodies(robot, forward_kinematics(robot, q));
    const std::vector<PlacedShape> later = placed_bodies(robot, forward_kinematics(robot, q + h * speed));
    move_bodies(robot, forward_kinematics(robot, q), speed, shapes);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Eigen::Vector3d local = random.point(0.3);
      const Eigen::Vector3d numeric = (later[i].pose * local - shapes[i].pose * local) / h;
      EXPECT_NEAR((shapes[i].velocity_at(shapes[i].pose * local) - numeric).norm(), 0.0, 1e-5);
    }
  }
}

TEST(ObstacleConstraints, WhatOverlapsIsAtDistanceZeroAndIsPushedApart) {
  const Robot robot = load_robot("point");  // a disc of radius 0.2
  const ObstacleConstraints near(robot);
  std::vector<PlacedShape> shapes{{Shape::box({0.2, 0.2, 0.2})}};
  shapes[0].pose.translation() = Eigen::Vector3d(0.1, 0.0, 0.0);
  std::vector<ObstacleConstraint> constraints;
  near.append(forward_kinematics(robot, Eigen::Vector2d(0.0, 0.0)), shapes, 0.1, constraints);
  ASSERT_EQ(constraints.size(), 1U);
  EXPECT_EQ(constraints[0].distance, 0.0);
  EXPECT_NEAR(constraints[0].gradient[0], 1.0, 1e-9);
}

}  // namespace obstacle_rows_test
}  // namespace clearway
