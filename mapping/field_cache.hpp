#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "mapping/blocked_field.hpp"

namespace clearway {

/// The blocked spaces of one tree, each built once for equal arguments. Safe to use from many threads. When
/// they would exceed the memory limit together, the oldest make room; whoever still holds one keeps it alive.
class FieldCache {
 public:
  FieldCache(std::shared_ptr<const FusedTree> tree, std::size_t memory_limit)
      : tree_(std::move(tree)), memory_limit_(memory_limit) {}

  /// @throws std::invalid_argument as field_region does.
  std::shared_ptr<const BlockedField> get(const Requirement& requirement, const Eigen::AlignedBox3d& region,
                                          double max_distance);

 private:
  struct Entry {
    Requirement requirement;
    Eigen::AlignedBox3d region;
    double max_distance;
    std::shared_ptr<const BlockedField> space;
  };
  void make_room(std::size_t bytes);

  std::shared_ptr<const FusedTree> tree_;
  std::size_t memory_limit_;
  std::mutex building_;
  std::vector<Entry> entries_;  ///< oldest first
};

}  // namespace clearway
