#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "mapping/free_space_map.hpp"

namespace clearway {

/// A map for tests: boxes of occupied voxels and painted spheres.
struct VoxelScene {
  double resolution = 0.05;
  std::vector<Eigen::AlignedBox3d> occupied;  ///< every voxel whose centre lies inside is occupied
  std::vector<Sphere> painted;                ///< one volume, for every part of `critical_parts`
  std::vector<std::string> critical_parts;

  Snapshot snapshot() const {
    MapOptions options;
    options.resolution = resolution;
    FreeSpaceMap map(options);
    if (!painted.empty()) {
      const int volume = map.add_volume("free", critical_parts);
      for (const Sphere& sphere : painted) map.paint(volume, sphere);
    }
    for (const Eigen::AlignedBox3d& box : occupied) occupy(map, box);
    return map.snapshot();
  }

 private:
  /// One scan per voxel, taken from inside that voxel, so that no ray frees a neighbour.
  void occupy(FreeSpaceMap& map, const Eigen::AlignedBox3d& box) const {
    const auto first = [&](double low) { return static_cast<int>(std::ceil(low / resolution - 0.5)); };
    for (int x = first(box.min().x()); (x + 0.5) * resolution <= box.max().x(); ++x) {
      for (int y = first(box.min().y()); (y + 0.5) * resolution <= box.max().y(); ++y) {
        for (int z = first(box.min().z()); (z + 0.5) * resolution <= box.max().z(); ++z) {
          Scan scan;
          scan.map_from_sensor.translation() = resolution * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
          scan.points = {Eigen::Vector3f(static_cast<float>(0.2 * resolution), 0.0f, 0.0f)};
          map.insert(scan);
        }
      }
    }
  }
};

inline Eigen::AlignedBox3d box_of(double x0, double y0, double z0, double x1, double y1, double z1) {
  return {Eigen::Vector3d(x0, y0, z0), Eigen::Vector3d(x1, y1, z1)};
}

}  // namespace clearway
