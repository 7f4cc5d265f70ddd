#include "mapping/scan_rays.hpp"

#include <cstdlib>
#include <optional>

#include "mapping/scan_filter.hpp"

namespace clearway {
namespace {

using octomap::KeySet;
using octomap::OcTreeKey;
using octomap::point3d;

/// Collects the voxels of one scan before any of them is updated.
class RaySet {
 public:
  RaySet(const FusedTree& tree, const Eigen::Vector3d& origin, double max_range)
      : tree_(tree),
        origin_(static_cast<float>(origin.x()), static_cast<float>(origin.y()),
                static_cast<float>(origin.z())),
        max_range_(max_range) {
    origin_valid_ = key_of(origin_).has_value();
  }

  bool origin_valid() const { return origin_valid_; }

  void add(const Eigen::Vector3f& measured, bool discretize, ScanCounts& counts) {
    point3d end(measured.x(), measured.y(), measured.z());
    std::optional<OcTreeKey> key = key_of(end);
    const bool repeated = discretize && key && !ends_.insert(*key).second;
    if (discretize && key) end = tree_.keyToCoord(*key);

    const bool beyond = max_range_ > 0.0 && (end - origin_).norm() > max_range_;
    if (beyond) {
      end = origin_ + (end - origin_).normalized() * static_cast<float>(max_range_);
      key = key_of(end);
    }
    if (!key || !fits_ray(*key)) {
      ++counts.dropped_invalid;
      return;
    }
    ++(beyond ? counts.beyond_range : counts.inserted);
    if (repeated) return;
    if (tree_.computeRayKeys(origin_, end, ray_)) free_.insert(ray_.begin(), ray_.end());
    if (!beyond) occupied_.insert(*key);
  }

  void update(FusedTree& tree) const {
    for (const OcTreeKey& key : free_) {
      if (occupied_.find(key) == occupied_.end()) tree.updateNode(key, false);
    }
    for (const OcTreeKey& key : occupied_) tree.updateNode(key, true);
  }

 private:
  /// Refuses what coordToKeyChecked would wrap: it converts to int before it compares.
  std::optional<OcTreeKey> key_of(const point3d& point) const {
    OcTreeKey key;
    if (!tree_.cell({point.x(), point.y(), point.z()})) return std::nullopt;
    if (!tree_.coordToKeyChecked(point, key)) return std::nullopt;
    return key;
  }

  /// octomap::KeyRay holds 100,000 keys and writes past its end without asserts.
  bool fits_ray(const OcTreeKey& end) const {
    const OcTreeKey start = *key_of(origin_);
    int steps = 0;
    for (unsigned axis = 0; axis < 3; ++axis) steps += std::abs(int{end[axis]} - int{start[axis]});
    return steps < 99000;
  }

  const FusedTree& tree_;
  point3d origin_;
  double max_range_;
  bool origin_valid_ = false;
  octomap::KeyRay ray_;
  KeySet free_, occupied_, ends_;
};

}  // namespace

ScanCounts insert_scan(FusedTree& tree, const Scan& scan, const ScanFilter& filter, bool discretize) {
  const FilteredPoints kept = filter_points(scan, filter);
  ScanCounts counts;
  counts.dropped_invalid = kept.dropped_invalid;
  counts.dropped_filter = kept.dropped_filter;
  RaySet rays(tree, kept.origin, filter.max_range);
  if (!rays.origin_valid()) {
    counts = {};
    counts.dropped_invalid = scan.points.size();
    counts.origin_invalid = true;
    return counts;
  }
  for (const Eigen::Vector3f& point : kept.points) rays.add(point, discretize, counts);
  rays.update(tree);
  return counts;
}

}  // namespace clearway
