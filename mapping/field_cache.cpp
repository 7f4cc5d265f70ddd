#include "mapping/field_cache.hpp"

#include "mapping/fused_tree.hpp"

namespace clearway {

std::shared_ptr<const BlockedField> FieldCache::get(const Requirement& requirement,
                                                    const Eigen::AlignedBox3d& region, double max_distance) {
  const FieldRegion cells = field_region(region, tree_->getResolution(), max_distance, memory_limit_);
  const std::lock_guard lock(building_);
  for (const Entry& entry : entries_) {
    if (entry.requirement == requirement && entry.region.min() == region.min() &&
        entry.region.max() == region.max() && entry.max_distance == max_distance) {
      return entry.space;
    }
  }
  make_room(field_bytes(cells));
  auto space = std::make_shared<const BlockedField>(*tree_, requirement, cells);
  entries_.push_back({requirement, region, max_distance, space});
  return space;
}

void FieldCache::make_room(std::size_t bytes) {
  for (const Entry& entry : entries_) bytes += field_bytes(entry.space->cells());
  while (!entries_.empty() && bytes > memory_limit_) {
    bytes -= field_bytes(entries_.front().space->cells());
    entries_.erase(entries_.begin());
  }
}

}  // namespace clearway
