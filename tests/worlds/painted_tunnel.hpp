#pragma once

#include <string>
#include <vector>

#include "tests/worlds/random_world.hpp"

namespace clearway {

/// A painted tube about the way that a robot's hand takes through `vias` random configurations: a winding
/// task. The hand's bounding sphere fits into each painted sphere with two voxels to spare.
struct PaintedTunnel {
  Snapshot map;
  Configuration start, goal;

  PaintedTunnel(const Robot& robot, std::uint64_t seed, int vias, double resolution) {
    Random random(seed);
    const Body& hand = critical_body(robot);
    const double radius = hand.shape.bounding_radius() + 2.0 * resolution;
    for (bool is_task = false; !is_task;) {
      FreeSpaceMap fused({.resolution = resolution});
      const Policies anywhere{.parts = {}, .other = Policy::not_occupied, .critical_by_default = false};
      const ConfigurationSpace open(robot, fused.snapshot(), anywhere);
      const std::vector<Configuration> way = random_way(open, random, vias);
      if (way.empty()) continue;
      const int volume = fused.add_volume("tube", robot.critical_parts);
      Eigen::Vector3d last = Eigen::Vector3d::Constant(1e9);
      for (std::size_t i = 1; i < way.size(); ++i) {
        for (int k = 0; k <= 100; ++k) {
          const Configuration q = way[i - 1] + k / 100.0 * (way[i] - way[i - 1]);
          const Eigen::Vector3d at = forward_kinematics(robot, q)[static_cast<std::size_t>(hand.link)] *
                                     hand.link_from_shape.translation();
          const bool is_last = i + 1 == way.size() && k == 100;
          if ((at - last).norm() < radius / 3.0 && !is_last) continue;
          fused.paint(volume, {at, radius});
          last = at;
        }
      }
      map = fused.snapshot();
      start = way.front(), goal = way.back();
      const ConfigurationSpace space(robot, map);
      is_task = space.is_free(start) && space.is_free(goal) && !space.is_edge_free(start, goal);
    }
  }

  static const Body& critical_body(const Robot& robot) {
    for (const Body& body : robot.bodies) {
      if (body.part == robot.critical_parts.front()) return body;
    }
    return robot.bodies.back();
  }

 private:
  static std::vector<Configuration> random_way(const ConfigurationSpace& open, Random& random, int vias) {
    std::vector<Configuration> way{random.configuration(open.robot())};
    for (int tries = 0; open.is_free(way.front()) && tries < 200; ++tries) {
      Configuration next = way.back();
      for (double& value : next) value += random.between(-0.9, 0.9);
      if (open.is_edge_free(way.back(), next)) way.push_back(next);
      if (static_cast<int>(way.size()) == vias + 2) return way;
    }
    return {};
  }
};

}  // namespace clearway
