#pragma once

// Maps about an arm, for what judges and measures configuration checks.

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "mapping/free_space_map.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway::bench {

/// Seeded numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) { return low + (high - low) * random_unit(engine_); }
  Eigen::Vector3d point(const Eigen::AlignedBox3d& box) {
    return {between(box.min().x(), box.max().x()), between(box.min().y(), box.max().y()),
            between(box.min().z(), box.max().z())};
  }
  /// Uniform within the limits.
  Configuration configuration(const Robot& robot) {
    Configuration q(static_cast<Eigen::Index>(robot.dof()));
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      q[static_cast<Eigen::Index>(j)] = between(robot.joints[j].lower, robot.joints[j].upper);
    }
    return q;
  }

 private:
  std::mt19937_64 engine_;
};

/// A closed room about an arm that stands at the origin, with spheres hanging in it, as `views` sensors see
/// it: free where rays pass, occupied where they end, unknown behind the spheres. With `painted` > 0 that
/// many spheres of free space, where the arm's tip gets, are painted for the parts `critical`.
struct ArmWorld {
  double resolution = 0.02;
  double half = 1.0;  ///< of the room, metres
  int views = 3, spheres = 20;
  double gap = 0.02;  ///< between neighbouring rays at the wall, metres
  int painted = 0;
  std::vector<std::string> critical{};
  std::uint64_t seed = 1;

  /// What the sensors see.
  std::vector<Scan> scans() const;
  Snapshot snapshot(const Robot& robot) const;

 private:
  std::vector<Scan> scans(Dice& dice) const;
};

namespace detail {

/// Metres along the unit ray until the room's wall or a sphere.
inline double range(const Eigen::Vector3d& from, const Eigen::Vector3d& way, const Eigen::AlignedBox3d& room,
                    const std::vector<Sphere>& spheres) {
  double nearest = 1e9;
  for (int i = 0; i < 3; ++i) {
    if (way[i] == 0.0) continue;
    nearest = std::min(nearest, ((way[i] > 0.0 ? room.max()[i] : room.min()[i]) - from[i]) / way[i]);
  }
  for (const Sphere& sphere : spheres) {
    const Eigen::Vector3d to = sphere.center - from;
    const double along = to.dot(way), aside = to.squaredNorm() - along * along;
    const double within = sphere.radius * sphere.radius - aside;
    if (along > 0.0 && within > 0.0) nearest = std::min(nearest, along - std::sqrt(within));
  }
  return std::max(nearest, 0.0);
}

}  // namespace detail

inline std::vector<Scan> ArmWorld::scans(Dice& dice) const {
  // A third of a voxel off the grid: walls that lie in one layer of voxels.
  const Eigen::AlignedBox3d room(Eigen::Vector3d(-half, -half, -0.2).array() + resolution / 3,
                                 Eigen::Vector3d(half, half, 2 * half - 0.2).array() + resolution / 3);
  std::vector<Sphere> obstacles;
  while (static_cast<int>(obstacles.size()) < spheres) {
    const Sphere sphere{dice.point(room), dice.between(0.03, 0.15)};
    if (sphere.center.head<2>().norm() > 0.3) obstacles.push_back(sphere);
  }
  std::vector<Scan> scans;
  for (int view = 0; view < views; ++view) {
    Scan scan;
    scan.map_from_sensor.translation() = dice.point({(0.9 * room.min()).eval(), (0.9 * room.max()).eval()});
    const Eigen::Vector3d from = scan.map_from_sensor.translation();
    const int steps = static_cast<int>(2.0 * half / gap);  // rays to a grid on each wall
    for (int face = 0; face < 6; ++face) {
      for (int i = 0; i < steps * steps; ++i) {
        Eigen::Vector3d at = room.min();
        const int axis = face % 3;
        if (face >= 3) at[axis] = room.max()[axis];
        at[(axis + 1) % 3] += (i % steps + 0.5) * gap;
        at[(axis + 2) % 3] += (i / steps + 0.5) * gap;
        const Eigen::Vector3d way = (at - from).normalized();
        const double range = detail::range(from, way, room, obstacles);
        scan.points.push_back((range * way).cast<float>());
      }
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

inline std::vector<Scan> ArmWorld::scans() const {
  Dice dice(seed);
  return scans(dice);
}

inline Snapshot ArmWorld::snapshot(const Robot& robot) const {
  Dice dice(seed);
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  for (const Scan& scan : scans(dice)) map.insert(scan);
  if (painted > 0) {
    const int volume = map.add_volume("free", critical);
    for (int i = 0; i < painted; ++i) {
      const Eigen::Vector3d tip = tip_pose(robot, dice.configuration(robot)).translation();
      map.paint(volume, {tip, dice.between(0.15, 0.4)});
    }
  }
  return map.snapshot();
}

}  // namespace clearway::bench
