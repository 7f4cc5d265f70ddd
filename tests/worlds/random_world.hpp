#pragma once

// Seeded random numbers, poses, bodies and maps for the tests of planning. The same on every machine: only
// mt19937_64's bits are used, no standard distribution.

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "mapping/free_space_map.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return random_unit(engine_); }
  double between(double low, double high) { return low + (high - low) * unit(); }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }

  Eigen::Vector3d point(double half) {
    return {between(-half, half), between(-half, half), between(-half, half)};
  }

  Eigen::Isometry3d pose(double half) {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    const double a = unit(), b = 2 * std::numbers::pi * unit(), c = 2 * std::numbers::pi * unit();
    result.linear() = Eigen::Quaterniond(std::sqrt(1 - a) * std::sin(b), std::sqrt(1 - a) * std::cos(b),
                                         std::sqrt(a) * std::sin(c), std::sqrt(a) * std::cos(c))
                          .toRotationMatrix();
    result.translation() = point(half);
    return result;
  }

  Configuration configuration(const Robot& robot) {
    Configuration q(static_cast<Eigen::Index>(robot.dof()));
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const double lower = std::max(robot.joints[j].lower, -2 * std::numbers::pi);
      const double upper = std::min(robot.joints[j].upper, 2 * std::numbers::pi);
      q[static_cast<Eigen::Index>(j)] = between(lower, upper);
    }
    return q;
  }

 private:
  std::mt19937_64 engine_;
};

/// Marks one voxel as an obstacle: a ray of almost no length that ends in it.
inline void occupy(FreeSpaceMap& map, const Eigen::Vector3d& voxel_center) {
  Scan scan;
  scan.map_from_sensor.translation() = voxel_center;
  scan.points = {Eigen::Vector3f(1e-4F, 0.0F, 0.0F)};
  map.insert(scan);
}

}  // namespace clearway
