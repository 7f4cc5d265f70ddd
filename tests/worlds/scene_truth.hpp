#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/geometry/shape.hpp"

namespace clearway::worlds {

using Json = nlohmann::json;

/// A shape of the scene, from truth.json.
struct Obstacle {
  std::string name;
  Shape shape;
  Eigen::Isometry3d map_from_shape;

  bool contains(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = map_from_shape.inverse() * point;
    switch (shape.kind()) {
      case Shape::Kind::box:
        return (p.cwiseAbs() - 0.5 * shape.edges()).maxCoeff() <= 0.0;
      case Shape::Kind::cylinder:
        return p.head<2>().norm() <= shape.radius() && std::abs(p.z()) <= 0.5 * shape.length();
      default:
        return p.norm() <= shape.radius();
    }
  }

  /// All shapes are convex: a cube lies inside when its corners do.
  bool holds_cube(const Eigen::Vector3d& center, double edge) const {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d offset(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      if (!contains(center + edge * offset)) return false;
    }
    return true;
  }
};

inline Eigen::Vector3d vector_of(const Json& json) {
  const auto numbers = json.get<std::vector<double>>();
  return Eigen::Vector3d(numbers.at(0), numbers.at(1), numbers.at(2));
}

inline Shape shape_of(const Json& json) {
  if (json.contains("box")) return Shape::box(vector_of(json["box"]));
  if (json.contains("cylinder"))
    return Shape::cylinder(json["cylinder"][0].get<double>(), json["cylinder"][1].get<double>());
  return Shape::sphere(json["sphere"].get<double>());
}

inline std::vector<Obstacle> read_obstacles(const Json& truth) {
  std::vector<Obstacle> obstacles;
  for (const auto& json : truth["shapes"]) {
    const auto pose = json["map_from_shape"].get<std::vector<double>>();
    Eigen::Isometry3d map_from_shape = Eigen::Isometry3d::Identity();
    map_from_shape.translation() = Eigen::Vector3d(pose[0], pose[1], pose[2]);
    map_from_shape.linear() = Eigen::Quaterniond(pose[3], pose[4], pose[5], pose[6]).toRotationMatrix();
    obstacles.push_back({json["name"].get<std::string>(), shape_of(json), map_from_shape});
  }
  return obstacles;
}

/// Calls `visit(centre)` for each finest voxel of a leaf.
template <typename Visit>
void for_each_voxel(const Voxel& leaf, double resolution, const Visit& visit) {
  const int count = static_cast<int>(std::lround(leaf.size / resolution));
  const Eigen::Vector3d low = leaf.center - Eigen::Vector3d::Constant(0.5 * leaf.size - 0.5 * resolution);
  for (int x = 0; x < count; ++x) {
    for (int y = 0; y < count; ++y) {
      for (int z = 0; z < count; ++z) visit(Eigen::Vector3d(low + resolution * Eigen::Vector3d(x, y, z)));
    }
  }
}

/// Voxels that a map calls free, and where it is wrong.
struct FreeVoxels {
  std::size_t free = 0;                 ///< voxels that the map calls seen free
  std::size_t inside = 0;               ///< of these, wholly inside an obstacle
  std::map<std::string, int> culprits;  ///< by obstacle, with the last one's place
};

inline FreeVoxels count_free(const Snapshot& map, const std::vector<Obstacle>& obstacles) {
  FreeVoxels counts;
  map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != VoxelState::seen_free) return;
    for_each_voxel(leaf, map.resolution(), [&](const Eigen::Vector3d& center) {
      ++counts.free;
      for (const Obstacle& obstacle : obstacles) {
        if (!obstacle.holds_cube(center, map.resolution())) continue;
        ++counts.inside;
        std::ostringstream place;
        place << obstacle.name << " at " << center.transpose();
        ++counts.culprits[place.str()];
      }
    });
  });
  return counts;
}

}  // namespace clearway::worlds
