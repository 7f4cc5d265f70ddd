#include "mapping/scan_rays.hpp"

#include <optional>

#include "mapping/scan_filter.hpp"

namespace clearway {
namespace {

using octomap::point3d;

/// Where a point of a scan counts: the end of its ray, and whether that is a hit.
class EndChooser {
 public:
  EndChooser(const FusedTree& tree, const Eigen::Vector3f& origin, double max_range, bool discretize)
      : tree_(tree),
        origin_(origin.x(), origin.y(), origin.z()),
        max_range_(max_range),
        discretize_(discretize) {}

  void add(const Eigen::Vector3f& measured, ScanWorkspace& workspace, ScanCounts& counts) const {
    Eigen::Vector3f point = measured;
    std::optional<Eigen::Vector3i> cell = tree_.cell(measured.cast<double>());
    const bool repeated = discretize_ && cell && !workspace.seen.set_occupied(*cell);
    if (discretize_ && cell)
      point = ((cell->cast<double>().array() + 0.5) * tree_.getResolution()).cast<float>();  // keyToCoord
    const bool beyond = max_range_ > 0.0 && is_beyond(point);
    if (beyond) {
      point = shorten(point);
      cell = tree_.cell(point.cast<double>());
    }
    if (!cell) {
      ++counts.dropped_invalid;
      return;
    }
    ++(beyond ? counts.beyond_range : counts.inserted);
    if (repeated) return;
    workspace.chosen.ends.push_back({point});
    if (!beyond) workspace.grid.set_occupied(*cell);
  }

 private:
  bool is_beyond(const Eigen::Vector3f& point) const {
    return (point3d(point.x(), point.y(), point.z()) - origin_).norm() > max_range_;
  }

  Eigen::Vector3f shorten(const Eigen::Vector3f& point) const {
    const point3d way = point3d(point.x(), point.y(), point.z()) - origin_;
    const point3d end = origin_ + way.normalized() * static_cast<float>(max_range_);
    return {end.x(), end.y(), end.z()};
  }

  const FusedTree& tree_;
  point3d origin_;
  double max_range_;
  bool discretize_;
};

}  // namespace

ScanRays& choose_rays(const FusedTree& tree, const Scan& scan, const ScanFilter& filter, bool discretize,
                      ScanWorkspace& workspace, ScanCounts& counts) {
  workspace.grid.clear();
  workspace.seen.clear();
  workspace.chosen.ends.clear();
  const FilteredPoints kept = filter_points(scan, filter);
  counts = {};
  workspace.chosen.origin = kept.origin.cast<float>();
  if (!kept.origin.allFinite() || !tree.cell(workspace.chosen.origin.cast<double>())) {
    counts.dropped_invalid = scan.points.size();
    counts.origin_invalid = true;
    return workspace.chosen;
  }
  counts.dropped_invalid = kept.dropped_invalid;
  counts.dropped_filter = kept.dropped_filter;
  workspace.chosen.ends.reserve(kept.points.size());
  const EndChooser chooser(tree, workspace.chosen.origin, filter.max_range, discretize);
  for (const Eigen::Vector3f& point : kept.points) chooser.add(point, workspace, counts);
  return workspace.chosen;
}

ScanCounts insert_scan(FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                       const ScanInsertion& insertion, ScanWorkspace& workspace) {
  ScanCounts counts;
  const ScanRays& rays = choose_rays(tree, scan, filter, insertion.discretize, workspace, counts);
  cast_rays(rays, tree.getResolution(), insertion.threads, insertion.instructions, workspace.rays,
            workspace.grid);
  tree.update(workspace.grid, insertion.threads);
  return counts;
}

}  // namespace clearway
