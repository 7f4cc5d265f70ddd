#pragma once

#include <filesystem>
#include <memory>

#include "mapping/files/octree_check.hpp"

namespace clearway {

class FusedTree;

/// Builds the tree of an OctoMap file in one pass and without recursion, and checks each node on the way: at
/// most 16 levels, as many nodes as the header says, finite log-odds, known flags, nothing after the last
/// node. Nodes of ClearwayFusedTree keep their flags; leaves of other types become observed voxels, pruned;
/// inner nodes are worked out from their children. Takes at most 20 times the memory of a .ot file, 120 times
/// that of a .bt file (two bytes there can stand for nine nodes).
/// @throws DamagedFile naming `file` and what is wrong.
std::shared_ptr<FusedTree> read_tree(const CheckedOctree& checked, const std::filesystem::path& file);

}  // namespace clearway
