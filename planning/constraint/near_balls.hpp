#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mapping/field/blocked_space.hpp"
#include "mapping/voxels/sphere.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// A ball of a body's cover that is near blocked space.
struct NearBall {
  int body = 0;           ///< as they were added
  bool is_close = false;  ///< nearer than `close` of its body
  double radius = 0.0;
  double reach = 0.0;      ///< of its body: metres from its surface
  Eigen::Vector3d center;  ///< map frame
};

/// What distances count for a body; metres from its surface.
struct BallReach {
  double near = 0.0;   ///< balls that are farther from blocked space are left out
  double close = 0.0;  ///< nearer ones are marked
};

/// Which cover balls of some bodies may be within reach of blocked space, for loops: bodies as a whole from
/// one cell of the distance field, then their balls from one cell each, then closely. It allocates nothing
/// after the last `add`.
class NearBalls {
 public:
  /// @param space must live as long.
  explicit NearBalls(const BlockedSpace& space) : space_(space) {}

  /// @param bound holds the body, its cover holds the body; link frame.
  void add(int link, const Sphere& bound, std::span<const Sphere> cover);

  /// @param reach of each body, as they were added
  /// @return in the order in which bodies and balls were added; valid until the next call
  std::span<const NearBall> look(const LinkPoses& map_from_link, std::span<const BallReach> reach);

  std::size_t size() const { return balls_.size(); }  ///< of all balls

 private:
  struct Cover {
    int link;
    Sphere bound;
    int first, last;  ///< of balls_
  };
  struct Ball {
    Sphere sphere;
    int body;
  };
  void put(std::size_t at, const Eigen::Isometry3d& pose, const Eigen::Vector3d& point);
  void look_up(std::size_t count, bool closely);
  std::size_t keep_near(std::size_t count, std::span<const BallReach> reach);

  const BlockedSpace& space_;
  std::vector<Cover> covers_;
  std::vector<Ball> balls_;
  std::vector<int> ball_of_;                   ///< of the points that are looked up
  std::vector<double> x_, y_, z_, clearance_;  ///< of these, filled up to whole registers
  std::vector<NearBall> near_;
};

}  // namespace clearway
