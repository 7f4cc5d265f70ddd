#include "mapping/scan_rays.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/point_batch.hpp"
#include "mapping/safe_scan.hpp"
#include "mapping/scan_filter.hpp"

namespace clearway {
namespace {

using octomap::point3d;

/// Decides point by point where its ray ends, and whether that is a hit.
class EndChooser {
 public:
  EndChooser(const FusedTree& tree, double max_range, const ScanInsertion& insertion,
             ScanWorkspace& workspace, ScanCounts& counts)
      : tree_(tree), max_range_(max_range), insertion_(insertion), work_(workspace), counts_(counts) {
    const Eigen::Vector3f& origin = workspace.chosen.origin;
    origin_ = point3d(origin.x(), origin.y(), origin.z());
  }

  void add(const PointBatch& points, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((points.has_cell >> i & 1U) == 0) {
        add_without_cell(points.point(i), (points.finite >> i & 1U) != 0);
      } else if (insertion_.discretize) {
        add_cell(points.cell(i));
      } else {
        add_point(points.point(i), points.cell(i), false);
      }
    }
  }

 private:
  /// Beyond the tree; its ray may still end at max_range.
  void add_without_cell(const Eigen::Vector3f& point, bool finite) {
    if (finite && is_beyond(point)) return add_point(point, Eigen::Vector3i::Zero(), false);
    ++counts_.dropped_invalid;
  }

  void add_cell(const Eigen::Vector3i& cell) {
    const bool repeated = cell == last_cell_ || !work_.seen.set_occupied(cell);
    last_cell_ = cell;
    const Eigen::Array3d centre = (cell.cast<double>().array() + 0.5) * tree_.getResolution();  // keyToCoord
    add_point(centre.cast<float>(), cell, repeated);
  }

  void add_point(const Eigen::Vector3f& point, const Eigen::Vector3i& cell, bool repeated) {
    if (!is_beyond(point)) {
      ++counts_.inserted;
      if (repeated) return;
      work_.chosen.ends.push_back({point, reach(point)});
      work_.grid.set_occupied(cell);
      return;
    }
    const point3d way = point3d(point.x(), point.y(), point.z()) - origin_;
    const point3d end = origin_ + way.normalized() * static_cast<float>(max_range_);
    if (!tree_.cell({end.x(), end.y(), end.z()})) {
      ++counts_.dropped_invalid;
      return;
    }
    ++counts_.beyond_range;
    if (!repeated) work_.chosen.ends.push_back({{end.x(), end.y(), end.z()}});
  }

  /// How far the ray of a hit frees.
  float reach(const Eigen::Vector3f& point) const {
    if (insertion_.integration == Integration::compatible) return std::numeric_limits<float>::infinity();
    const double length = (point3d(point.x(), point.y(), point.z()) - origin_).norm();
    return static_cast<float>(std::max(0.0, length - insertion_.margins.trim(length)));
  }

  bool is_beyond(const Eigen::Vector3f& point) const {
    return max_range_ > 0.0 && (point3d(point.x(), point.y(), point.z()) - origin_).norm() > max_range_;
  }

  const FusedTree& tree_;
  double max_range_;
  const ScanInsertion& insertion_;
  ScanWorkspace& work_;
  ScanCounts& counts_;
  point3d origin_;
  Eigen::Vector3i last_cell_ = Eigen::Vector3i::Constant(65536);  // no point's
};

/// True when the filter keeps every point, so that scans need not go through filter_points.
bool keeps_all(const ScanFilter& filter) {
  return filter.min_range == 0.0 && filter.thin_to == 0.0 && filter.crop.isEmpty() && filter.bodies.empty() &&
         std::isfinite(filter.max_range) && filter.max_range >= 0.0;
}

}  // namespace

ScanRays& choose_rays(const FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                      const ScanInsertion& insertion, ScanWorkspace& workspace, ScanCounts& counts) {
  workspace.grid.clear();
  workspace.seen.clear();
  workspace.chosen.ends.clear();
  counts = {};
  const bool whole = keeps_all(filter);
  const FilteredPoints kept = whole ? FilteredPoints{} : filter_points(scan, filter);
  const Eigen::Vector3d origin = scan.map_from_sensor.translation();
  workspace.chosen.origin = origin.cast<float>();
  if (!origin.allFinite() || !tree.cell(workspace.chosen.origin.cast<double>())) {
    counts.dropped_invalid = scan.points.size();
    counts.origin_invalid = true;
    return workspace.chosen;
  }
  counts.dropped_invalid = kept.dropped_invalid;
  counts.dropped_filter = kept.dropped_filter;
  const std::vector<Eigen::Vector3f>& points = whole ? scan.points : kept.points;
  const Eigen::Isometry3d pose = whole ? scan.map_from_sensor : Eigen::Isometry3d::Identity();
  EndChooser chooser(tree, filter.max_range, insertion, workspace, counts);
  PointBatch batch;
  for (std::size_t first = 0; first < points.size(); first += PointBatch::size) {
    const std::size_t count = std::min(PointBatch::size, points.size() - first);
    place_points(points.data() + first, count, pose, 1.0 / tree.getResolution(), insertion.instructions,
                 batch);
    chooser.add(batch, count);
  }
  return workspace.chosen;
}

ScanCounts insert_scan(FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                       const ScanInsertion& insertion, ScanWorkspace& workspace) {
  ScanCounts counts;
  const ScanRays& rays = choose_rays(tree, scan, filter, insertion, workspace, counts);
  cast_rays(rays, tree.getResolution(), insertion.threads, insertion.instructions, workspace.rays,
            workspace.grid);
  if (insertion.integration == Integration::safe) {
    spare_surfaces(workspace.grid, growth_of(insertion.margins.band, tree.getResolution()),
                   insertion.threads);
  }
  tree.update(workspace.grid, insertion.threads);
  return counts;
}

}  // namespace clearway
