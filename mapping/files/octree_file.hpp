#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/voxels/painted_volume.hpp"

namespace clearway {

class FusedTree;
class SeenStamps;

/// A tree and, where the file is ours, the exact painted volumes it was made from.
struct OctreeContent {
  std::shared_ptr<const FusedTree> tree;
  std::vector<PaintedVolume> volumes;
  bool has_volumes = false;                  ///< false: a bare tree, the voxels alone decide
  std::shared_ptr<const SeenStamps> seen{};  ///< null: the file does not say when voxels were last seen
};

struct CheckedOctree;

/// Our .ot file: OctoMap's format with our nodes. It names itself a ColorOcTree, whose nodes are as long: so
/// stock programs read it with the right log-odds, and what they take for colours are paint and flags. (Files
/// of earlier versions name our own type, which they do not know; convert_octree makes garbage of them.)
/// Comment lines, which stock readers skip, say so, and hold a seal (see octree_check.hpp), the occupancy
/// threshold, which integration made the map, how many records of a
/// damaged recording it was made of, and the painted volumes as in painted.csv. When voxels were last seen
/// follows the tree, where stock readers have stopped.
/// @param seen null: not known
std::string format_fused_tree(const FusedTree& tree, const std::vector<PaintedVolume>& volumes,
                              const SeenStamps* seen = nullptr);

/// Reads an OctoMap file: .ot of our type, OcTree, ColorOcTree or OcTreeStamped, or .bt. Leaves of foreign
/// trees become observed voxels; colours and stamps are ignored.
/// @throws DamagedFile naming `file` and what is wrong.
OctreeContent parse_octree(std::string_view bytes, const std::filesystem::path& file);

/// How many bytes of look times follow the nodes of a file of ours. @throws DamagedFile when the header names
/// none or more than `data`.
std::size_t seen_bytes(const CheckedOctree& checked, std::size_t data, const std::filesystem::path& file);

/// Gives `tree` what the header of a file says beside the nodes, and returns the painted volumes; none of a
/// file that is not ours. @throws DamagedFile naming `file` and what is wrong.
std::vector<PaintedVolume> restore_header(FusedTree& tree, const CheckedOctree& checked,
                                          const std::filesystem::path& file);

/// .ot of an octomap::ColorOcTree for other programs. What the map says of itself (damage of its recording,
/// changes by hand, a crop) goes with it, and with a .bt, in comments, which they skip. Log-odds are those of
/// the sensors less the occupancy threshold (so that stock programs, which compare with 0, agree); painted
/// voxels that no sensor saw are free. Colours: painted green, seen free blue, occupied grey, conflict red.
std::string format_color_tree(const FusedTree& tree);

/// .bt: occupied and conflict against free (painted or seen free).
std::string format_binary_tree(const FusedTree& tree);

}  // namespace clearway
