#pragma once

#include <string>
#include <vector>

#include "planning/planner_table.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway::worlds {

/// Boxes of occupied voxels of 5 cm.
inline VoxelScene walls(std::vector<Eigen::AlignedBox3d> boxes) { return {0.05, std::move(boxes), {}, {}}; }

/// A robot among walls, free wherever nothing is occupied.
struct WalledRobot {
  ConfigurationSpace space;
  PathCost cost;

  static Policies policies() {
    Policies chosen;
    chosen.critical_by_default = false;
    return chosen;
  }
  WalledRobot(const Robot& robot, const VoxelScene& scene)
      : space(robot, scene.snapshot(), policies()), cost(robot) {}

  PlanResult plan(const std::string& planner, const Configuration& start, const Configuration& goal,
                  const PlannerOptions& options = {}, std::uint64_t seed = 1) const {
    return make_planner(planner, options)->plan({space, cost, start, goal, seed});
  }
  bool is_certified(const std::vector<Configuration>& path) const {
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (!space.is_edge_free(path[i - 1], path[i])) return false;
    }
    return true;
  }
};

}  // namespace clearway::worlds
