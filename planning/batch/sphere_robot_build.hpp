#pragma once

// Private to sphere_robot: what the robot alone decides.

#include <memory>
#include <span>
#include <vector>

#include "planning/batch/sphere_robot.hpp"

namespace clearway {

constexpr double largest_sphere_robot = 100.0;  ///< metres; there rounding takes mm from what can be proved
constexpr double rounding_of_float = 6e-8;

/// What the spheres of a robot depend on but for where the map is.
struct SphereGround {
  std::vector<int> members;   ///< of each body of the robot: which of those that the map can block; -1: none
  std::vector<int> field_of;  ///< of each of these: which field it is looked up in
  double resolution = 0.0;    ///< of the map, metres
  std::vector<std::size_t> covers;  ///< how many spheres cover each body at that resolution
  bool operator==(const SphereGround& other) const {
    return members == other.members && field_of == other.field_of && covers == other.covers;
  }
};

/// Spheres without fields and padding.
struct BareSphereRobot {
  SphereGround ground;
  SphereRobot robot;
  double size = 0.0;       ///< no coordinate of the robot is larger, metres
  bool is_small = true;    ///< nor larger than is of use
  bool is_covered = true;  ///< all bodies, by spheres
};

/// Its frames, spheres, groups, levers, pairs and trees.
BareSphereRobot build_sphere_robot(std::shared_ptr<const Robot> robot, SphereGround ground,
                                   std::span<const BodyPair> pairs);

}  // namespace clearway
