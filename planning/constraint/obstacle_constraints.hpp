#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A shape among the robots: a moving obstacle, or a body of another robot. Map frame.
struct PlacedShape {
  Shape shape = Shape::sphere(1.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   ///< of the pose's origin, m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< about that origin, rad/s

  /// Velocity of the point of the shape that is now at `point`.
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& point) const {
    return linear_velocity + angular_velocity.cross(point - pose.translation());
  }
};

/// A damper constraint against a placed shape, Lahouar et al. 2006, eq. 5:
/// gradient . dq <= bound(distance) - approach_speed dt.
struct ObstacleConstraint : ProximityConstraint {
  int obstacle = 0;  ///< which of the placed shapes
  Eigen::Vector3d obstacle_point = Eigen::Vector3d::Zero();
  double approach_speed = 0.0;  ///< of obstacle_point along -normal, m/s: > 0 when it comes nearer
};

/// The constraints of one robot against placed shapes: one for each of its bodies and each shape nearer than
/// `influence_distance` (m), by certified distances (see `distance`), which are never too large; bodies whose
/// bounding spheres are farther apart are not looked at. Bodies first, in order, then shapes. Where they
/// overlap the distance is 0 and the normal goes from the body's middle to the shape's. Constraints that no
/// joint can change are left out: a shape that runs into a robot's fixed base is not the robot's to avoid.
class ObstacleConstraints {
 public:
  explicit ObstacleConstraints(const Robot& robot);

  /// Appends to `constraints`. Returns the smallest distance of what no constraint stands for, at most
  /// `influence_distance`: of bodies that no joint moves (a pedestal), or not away (a sphere on the axis of
  /// the joint that turns it).
  /// @param map_from_link of this robot.
  double append(const LinkPoses& map_from_link, std::span<const PlacedShape> shapes,
                double influence_distance, std::vector<ObstacleConstraint>& constraints) const;

 private:
  struct BoundingSphere {
    Eigen::Vector3d center;  ///< link frame
    double radius;
    bool is_moved;  ///< by some joint
  };
  const Robot* robot_;  ///< must live as long
  std::vector<BoundingSphere> spheres_;
};

/// A robot's bodies as shapes that others keep away from, at `map_from_link`, standing still.
std::vector<PlacedShape> placed_bodies(const Robot& robot, const LinkPoses& map_from_link);

/// Moves them to where the robot is now, with the velocities that joint velocities `speed` (rad/s, m/s) give.
/// @pre `shapes` are placed_bodies of the same robot.
void move_bodies(const Robot& robot, const LinkPoses& map_from_link, const Eigen::VectorXd& speed,
                 std::span<PlacedShape> shapes);

}  // namespace clearway
