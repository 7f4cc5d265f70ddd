#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mapping/files/octree_check.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/voxels/painted_volume.hpp"

namespace clearway {

class FusedNode;
class FusedTree;
class SeenStamps;
struct CellCube;

/// An OctoMap file that is read leaf by leaf, as often as one likes, in a fixed amount of memory: no tree is
/// made. It stays the file that was opened, also when another one takes its name.
class OctreeStream {
 public:
  /// Checks header and seal. @throws std::invalid_argument when the file cannot be read, DamagedFile naming
  /// it and what is wrong, both as load_map does.
  explicit OctreeStream(const std::filesystem::path& file);

  /// A tree without voxels, with all else that the file says of its tree.
  const FusedTree& bare_tree() const { return *bare_; }
  std::shared_ptr<const FusedTree> shared_bare_tree() const { return bare_; }
  const std::vector<PaintedVolume>& volumes() const { return volumes_; }  ///< none of a file that is not ours
  bool is_ours() const { return checked_.fused; }
  std::shared_ptr<const SeenStamps> seen() const { return seen_; }  ///< null: the file does not say
  const std::string& sha256() const { return sha256_; }             ///< of all its bytes, hexadecimal
  std::size_t nodes() const { return checked_.nodes; }

  /// Calls `visit` for each leaf; those of a .ot file come in the tree's order. What other programs wrote is
  /// not pruned. @throws DamagedFile as read_tree does.
  void visit_leaves(const std::function<void(const FusedNode&, const CellCube&)>& visit) const;

 private:
  std::string read_header() const;
  /// Takes the SHA-256; whether the seal in line 2 is right.
  bool digest();

  std::filesystem::path file_;
  InputFile input_;
  std::string header_;  ///< what checked_.header points into
  CheckedOctree checked_;
  std::size_t first_ = 0, last_ = 0;  ///< of the nodes' bytes
  std::string sha256_;
  std::shared_ptr<FusedTree> bare_;
  std::vector<PaintedVolume> volumes_;
  std::shared_ptr<const SeenStamps> seen_;
  mutable std::string piece_;
};

}  // namespace clearway
