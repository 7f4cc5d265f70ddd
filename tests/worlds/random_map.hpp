#pragma once

#include <array>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "mapping/free_space_map.hpp"
#include "mapping/snapshot.hpp"

namespace clearway::worlds {

/// Seeded uniform numbers.
class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  Eigen::Vector3d point(double reach) {
    return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
  }

 private:
  std::mt19937 engine_;
};

/// A scan from inside a bumpy shell: hits at 0.5 to 1 m in random directions.
inline Scan random_scan(Dice& dice, int points) {
  Scan scan;
  const Eigen::Vector3d axis = dice.point(1.0).normalized();
  scan.map_from_sensor.rotate(Eigen::AngleAxisd(dice.uniform(-3.0, 3.0), axis));
  scan.map_from_sensor.translation() = dice.point(0.2);
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector3d direction = dice.point(1.0).normalized();
    scan.points.push_back((direction * dice.uniform(0.5, 1.0)).cast<float>());
  }
  return scan;
}

/// The cube about the origin whose faces are `reach` from it.
inline Eigen::AlignedBox3d box_around(double reach) {
  return {Eigen::Vector3d::Constant(-reach), Eigen::Vector3d::Constant(reach)};
}

inline Sphere random_sphere(Dice& dice) { return {dice.point(0.8), dice.uniform(0.03, 0.3)}; }

/// Two painted volumes and some scans, interleaved.
inline FreeSpaceMap random_map(unsigned seed, double resolution = 0.05, int rounds = 4, int points = 200) {
  Dice dice(seed);
  MapOptions options;
  options.resolution = resolution;
  options.integration = Integration::compatible;  // frees more: more kinds of voxels side by side
  FreeSpaceMap map(options);
  map.add_volume("tunnel", {"tool", "load"});
  map.add_volume("dock", {"base"});
  for (int round = 0; round < rounds; ++round) {
    map.paint(dice.whole(0, 1), random_sphere(dice), 0.1 * round);
    map.insert(random_scan(dice, points));
    map.paint(dice.whole(0, 1), random_sphere(dice), 0.1 * round + 0.05);
  }
  return map;
}

using Cell = std::array<int, 3>;

inline Cell cell_of(const Eigen::Vector3d& point, double resolution) {
  const Eigen::Vector3i cell = (point / resolution).array().floor().cast<int>();
  return {cell.x(), cell.y(), cell.z()};
}

/// Voxels of a map by state, all leaves at the finest level.
inline std::set<Cell> cells_in(const Snapshot& map, VoxelState state) {
  std::set<Cell> cells;
  const double resolution = map.resolution();
  map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != state) return;
    const int edge = static_cast<int>(std::lround(leaf.size / resolution));
    const Cell low =
        cell_of(leaf.center - Eigen::Vector3d::Constant(0.5 * (leaf.size - resolution)), resolution);
    for (int x = 0; x < edge; ++x)
      for (int y = 0; y < edge; ++y)
        for (int z = 0; z < edge; ++z) cells.insert({low[0] + x, low[1] + y, low[2] + z});
  });
  return cells;
}

}  // namespace clearway::worlds
