#include "mapping/field/field_cache.hpp"

#include <algorithm>

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
FieldCache::FieldCache(std::shared_ptr<const FusedTree> tree, std::size_t memory_limit, FieldCache* previous,
                       std::shared_ptr<const SeenStamps> seen)
    : tree_(std::move(tree)), seen_(std::move(seen)), memory_limit_(memory_limit) {
  if (previous == nullptr) return;
  const std::lock_guard lock(previous->guard_);
  for (const Entry& entry : previous->entries_) {
    const bool comparable = entry.tree->getResolution() == tree_->getResolution() &&
                            entry.tree->getOccupancyThresLog() == tree_->getOccupancyThresLog();
    if (comparable) entries_.push_back(entry);
  }
}

std::shared_ptr<const BlockedField> FieldCache::get(const Requirement& requirement,
                                                    const Eigen::AlignedBox3d& region, double max_distance) {
  const FieldRegion cells = field_region(region, tree_->getResolution(), max_distance, memory_limit_);
  const std::lock_guard building(building_);  // only the one who builds changes the entries
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.requirement == requirement && entry.region.min() == region.min() &&
           entry.region.max() == region.max() && entry.max_distance == max_distance;
  });
  Entry entry{requirement, region, max_distance, nullptr, tree_, nullptr};
  if (requirement.seen_within > 0.0) entry.seen = seen_;
  if (found == entries_.end()) {
    entry.space = std::make_shared<const BlockedField>(*tree_, requirement, cells, entry.seen.get());
  } else {
    if (found->tree == tree_ && found->seen == entry.seen) return found->space;
    entry.space = std::make_shared<const BlockedField>(*tree_, *found->tree, *found->space, entry.seen.get());
  }
  const std::lock_guard lock(guard_);
  if (found != entries_.end()) entries_.erase(found);
  make_room(field_bytes(cells));
  entries_.push_back(entry);
  return entry.space;
}

void FieldCache::make_room(std::size_t bytes) {
  const auto taken = [](const Entry& entry) { return field_bytes(entry.space->cells()); };
  for (const Entry& entry : entries_) bytes += taken(entry);
  while (!entries_.empty() && bytes > memory_limit_) {
    bytes -= taken(entries_.front());
    entries_.erase(entries_.begin());
  }
}

}  // namespace clearway
