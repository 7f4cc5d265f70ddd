#pragma once

#include <memory>

#include "mapping/snapshot.hpp"

namespace octomap {
class OcTree;
}

namespace clearway {

/// The voxels that `requirement` forbids as occupied leaves of a stock OctoMap tree of the same resolution,
/// coarse where whole octants are blocked; all else is left out. Under `painted` and `known_free` the space
/// that the map does not know is blocked, too, as far as a tree goes (2^15 voxels from the origin).
std::shared_ptr<octomap::OcTree> blocked_octree(const Snapshot& map, const Requirement& requirement);

}  // namespace clearway
