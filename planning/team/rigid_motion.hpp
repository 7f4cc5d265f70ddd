#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "planning/constraint/obstacle_constraints.hpp"

namespace clearway {

/// A pose at a time.
struct TimedPose {
  double time = 0.0;  ///< s
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/// How something rigid moves: from pose to pose with constant velocity of its origin and constant rate of
/// turning about a fixed axis. Before the first pose and after the last one it stands still; or it repeats.
class RigidMotion {
 public:
  /// @param poses in the order of time; one: it never moves
  /// @param repeats after the last pose, which is the first again, all of it once more
  /// @throws std::invalid_argument for no poses, times that do not grow, values that are not finite, a motion
  ///         that repeats and does not end where it starts
  explicit RigidMotion(std::vector<TimedPose> poses, bool repeats = false);

  Eigen::Isometry3d pose(double time) const;

  /// Bounds on the speed of any point within `radius` (m) of the origin, at any time, m/s.
  double greatest_speed(double radius) const;

  const std::vector<TimedPose>& poses() const { return poses_; }
  bool repeats() const { return repeats_; }

 private:
  double within(double time) const;

  std::vector<TimedPose> poses_;
  bool repeats_;
};

/// A solid thing on a given way. Its shape's frame is what moves.
struct MovingObstacle {
  std::string name;
  Shape shape = Shape::sphere(1.0);
  RigidMotion motion{{TimedPose{}}};
  bool is_sensed = false;  ///< robots know of it from the map alone

  /// Where it is at `time`, with the mean velocities until `time + period`.
  PlacedShape placed(double time, double period) const;
  /// Bound on the speed of its points, m/s.
  double greatest_speed() const;
};

}  // namespace clearway
