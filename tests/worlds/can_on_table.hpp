#pragma once

#include <Eigen/Geometry>
#include <numbers>

#include "planning/problem/pick.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/voxel_scene.hpp"

/// What an arm6 picks from a table and puts behind a wall.
namespace clearway::can_on_table {

constexpr double edge = 0.02;
constexpr double top = 0.1;  ///< of the table, m

/// A table before the arm, a can on it as voxels, and a wall between the can and its place.
inline VoxelScene table() {
  return {edge,
          {box_of(0.24, -0.46, 0.04, 0.7, 0.46, top - 0.001),  // table
           box_of(0.375, 0.125, top, 0.465, 0.195, 0.239),     // can and a little more
           box_of(0.26, -0.02, top, 0.7, 0.02, 0.26)},         // wall
          {},
          {}};
}

inline Pick can() {
  Pick pick;
  pick.object.name = "can";
  pick.object.link = "hand";
  pick.object.shape = Shape::cylinder(0.03, 0.12);
  pick.object.mass = 0.3;
  pick.map_from_object.translation() << 0.42, 0.16, top + 0.06;
  pick.map_from_place.translation() << 0.42, -0.2, top + 0.06;
  pick.object_from_tip =
      Eigen::Translation3d(0.0, 0.0, 0.04) * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  pick.margin = 0.02;  // the can's voxels are those of a box about it
  return pick;
}

inline Policies anywhere() {
  Policies policies;
  policies.critical_by_default = false;
  return policies;
}

inline const Configuration home = (Configuration(6) << 0.0, -1.9, 1.7, -1.4, -1.57, 0.0).finished();

}  // namespace clearway::can_on_table
