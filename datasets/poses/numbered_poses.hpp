#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace clearway {

/// Poses by the number of their picture; empty where one is not known.
struct NumberedPoses {
  std::map<std::size_t, std::optional<Eigen::Isometry3d>> poses;
  bool have_numbers = false;  ///< false: the numbers are their places, from 0
  bool count_lines = false;   ///< numbers are places from 0, and pictures are called by them (TartanAir)
};

/// Four rows of four numbers, or the first three of them, world_from_camera, m; empty when they are not
/// finite (the data sets' way to say that it is not known). @throws std::invalid_argument naming `name` when
/// they are no rigid transform
std::optional<Eigen::Isometry3d> parse_pose_matrix(const std::string& text, const std::string& name);

/// Poses that have no times, world_from_camera, m: a line of 12 or 16 numbers for each picture, the rows of
/// its matrix (KITTI, Replica), or three lines of four (SUN3D), or of five lines, three numbers of which the
/// first is the picture's and the four rows of a matrix (Redwood's and Open3D's `.log`). Nothing for a text
/// whose first line is of another kind.
/// @throws std::invalid_argument naming `name`, the line and what was expected.
std::optional<NumberedPoses> parse_numbered_poses(const std::string& text, const std::string& name);

}  // namespace clearway
