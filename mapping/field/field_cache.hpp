#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "mapping/field/blocked_field.hpp"

namespace clearway {

/// The blocked spaces of one tree, each built once for equal arguments. Safe to use from many threads. When
/// they would exceed the memory limit together, the oldest make room; whoever still holds one keeps it alive.
class FieldCache {
 public:
  /// @param previous the cache of an earlier version of the same tree, or null: what it holds now is updated
  ///        instead of built, when the same is asked for. It may be destroyed afterwards.
  /// @param seen when the tree's voxels were last seen; null: not known
  FieldCache(std::shared_ptr<const FusedTree> tree, std::size_t memory_limit, FieldCache* previous = nullptr,
             std::shared_ptr<const SeenStamps> seen = nullptr);

  /// @throws std::invalid_argument as field_region and blocked_cells do.
  std::shared_ptr<const BlockedField> get(const Requirement& requirement, const Eigen::AlignedBox3d& region,
                                          double max_distance);

 private:
  struct Entry {
    Requirement requirement;
    Eigen::AlignedBox3d region;
    double max_distance;
    std::shared_ptr<const BlockedField> space;
    std::shared_ptr<const FusedTree> tree;   ///< what it was made of
    std::shared_ptr<const SeenStamps> seen;  ///< and, if it was asked for
  };
  void make_room(std::size_t bytes);

  std::shared_ptr<const FusedTree> tree_;
  std::shared_ptr<const SeenStamps> seen_;
  std::size_t memory_limit_;
  std::mutex building_;  ///< one at a time builds
  std::mutex guard_;  ///< of the entries, held briefly: whoever takes over this cache waits for no building
  std::vector<Entry>
      entries_;  ///< oldest first; of this tree, or of an earlier version and not yet asked for
};

}  // namespace clearway
