#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "apps/problem_sets/problem_set.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

/// The occupied voxels of an octomap_msgs/Octomap, as one solid of cubes. None: it has no data.
/// @param octomap `binary`, `id`, `resolution` and `data`, the bytes of a tree as numbers of 8 bits
/// @param map_from_octomap where its origin stands
/// @throws std::invalid_argument naming the field, also for bytes that are no tree of that kind.
std::optional<ForeignSolid> read_octomap(const YamlFields& octomap,
                                         const Eigen::Isometry3d& map_from_octomap);

}  // namespace clearway
