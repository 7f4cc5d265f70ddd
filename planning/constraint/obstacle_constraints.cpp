#include "planning/constraint/obstacle_constraints.hpp"

#include <algorithm>

#include "planning/constraint/near_pairs.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// The middle of the box around a shape, its own frame.
Eigen::Vector3d middle_of(const Shape& shape) { return shape.bounds(Eigen::Isometry3d::Identity()).center(); }

/// What Lahouar 2006, eq. 5 needs of a body and a shape, but for the gradient.
ObstacleConstraint constraint_between(const Body& body, const Eigen::Isometry3d& map_from_body,
                                      const PlacedShape& shape, double influence_distance) {
  const DistanceBounds bounds =
      distance(body.shape, map_from_body, shape.shape, shape.pose, influence_distance);
  ObstacleConstraint constraint;
  constraint.distance = bounds.lower;
  constraint.point = bounds.point_a;
  constraint.obstacle_point = bounds.point_b;
  constraint.normal = bounds.direction;
  const bool is_rounded_pair =
      body.shape.is_rounded() && shape.shape.is_rounded() && bounds.direction.squaredNorm() > 0.5;
  if (bounds.upper <= 0.0 && !is_rounded_pair) {  // they overlap, and witness points mean little
    constraint.point = map_from_body * middle_of(body.shape);
    constraint.obstacle_point = shape.pose * middle_of(shape.shape);
    constraint.normal = (constraint.obstacle_point - constraint.point).stableNormalized();
    constraint.point = constraint.obstacle_point = 0.5 * (constraint.point + constraint.obstacle_point);
  }
  constraint.approach_speed = -constraint.normal.dot(shape.velocity_at(constraint.obstacle_point));
  return constraint;
}

/// n^T J of a point that moves with `link`.
Eigen::VectorXd rate_of_approach(const Robot& robot, const LinkPoses& map_from_link, int link,
                                 const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  return jacobian(robot, map_from_link, link, point).topRows<3>().transpose() * normal;
}

}  // namespace

ObstacleConstraints::ObstacleConstraints(const Robot& robot) : robot_(&robot) {
  for (const Body& body : robot.bodies) {
    const Sphere sphere = sphere_around(body);
    spheres_.push_back({sphere.center, sphere.radius, is_moved(robot, body.link)});
  }
}

double ObstacleConstraints::append(const LinkPoses& map_from_link, std::span<const PlacedShape> shapes,
                                   double influence_distance,
                                   std::vector<ObstacleConstraint>& constraints) const {
  const Robot& robot = *robot_;
  double unavoidable = influence_distance;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const PlacedShape& shape = shapes[s];
    const double around = shape.shape.bounding_radius() * (1.0 + 1e-9) + influence_distance;
    for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
      const Body& body = robot.bodies[b];
      const Eigen::Isometry3d& pose = map_from_link[static_cast<std::size_t>(body.link)];
      const double apart = spheres_[b].radius + around;
      if ((shape.pose.translation() - pose * spheres_[b].center).squaredNorm() > apart * apart) continue;
      ObstacleConstraint constraint =
          constraint_between(body, pose * body.link_from_shape, shape, influence_distance);
      if (constraint.distance >= influence_distance || constraint.normal.squaredNorm() < 0.5) continue;
      constraint.body = static_cast<int>(b);
      constraint.obstacle = static_cast<int>(s);
      constraint.gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot.dof()));
      if (spheres_[b].is_moved)
        constraint.gradient =
            rate_of_approach(robot, map_from_link, body.link, constraint.point, constraint.normal);
      if (constraint.gradient.cwiseAbs().maxCoeff() > 1e-12) {
        constraints.push_back(std::move(constraint));
      } else {
        unavoidable = std::min(unavoidable, constraint.distance);
      }
    }
  }
  return unavoidable;
}

std::vector<PlacedShape> placed_bodies(const Robot& robot, const LinkPoses& map_from_link) {
  std::vector<PlacedShape> shapes;
  for (const Body& body : robot.bodies) {
    shapes.push_back({body.shape, map_from_link[static_cast<std::size_t>(body.link)] * body.link_from_shape});
  }
  return shapes;
}

void move_bodies(const Robot& robot, const LinkPoses& map_from_link, const Eigen::VectorXd& speed,
                 std::span<PlacedShape> shapes) {
  for (std::size_t b = 0; b < shapes.size(); ++b) {
    const Body& body = robot.bodies[b];
    PlacedShape& shape = shapes[b];
    shape.pose = map_from_link[static_cast<std::size_t>(body.link)] * body.link_from_shape;
    shape.linear_velocity.setZero();
    shape.angular_velocity.setZero();
    for (int i = body.link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
      const Link& mover = robot.links[static_cast<std::size_t>(i)];
      if (mover.joint < 0) continue;
      const Eigen::Isometry3d& pose = map_from_link[static_cast<std::size_t>(i)];
      const Eigen::Vector3d rate =
          mover.multiplier * speed[mover.joint] * (pose.linear() * axis_of(robot, mover));
      if (kind_of(robot, mover) == JointKind::revolute) {
        shape.linear_velocity += rate.cross(shape.pose.translation() - pose.translation());
        shape.angular_velocity += rate;
      } else {
        shape.linear_velocity += rate;
      }
    }
  }
}

}  // namespace clearway
