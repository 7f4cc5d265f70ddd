#include "mapping/scans/scan_rays.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "mapping/scans/compare_hits.hpp"
#include "mapping/scans/point_batch.hpp"
#include "mapping/scans/safe_scan.hpp"
#include "mapping/scans/scan_filter.hpp"
#include "mapping/scans/surface_gaps.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/parallel.hpp"
#include "mapping/voxels/memory_room.hpp"
#include "mapping/voxels/rigid_pose.hpp"

namespace clearway {
namespace {

using octomap::point3d;

/// A coordinate that no point's cell has.
constexpr int no_cell = 65536;

/// Decides point by point where its ray ends, and whether that is a hit.
class EndChooser {
 public:
  EndChooser(const FusedTree& tree, const Eigen::Vector3f& origin, double max_range,
             const ScanInsertion& insertion, ChosenEnds& chosen)
      : tree_(tree),
        origin_(origin.x(), origin.y(), origin.z()),
        max_range_(max_range),
        insertion_(insertion),
        out_(chosen) {}

  void add(const PointBatch& points, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((points.has_cell >> i & 1U) == 0) {
        add_without_cell(points.point(i), (points.finite >> i & 1U) != 0);
      } else if (insertion_.discretize) {
        if (insertion_.integration == Integration::safe && max_range_ > 0.0) {
          add_safe_cell(points.point(i), points.cell(i));
        } else {
          add_cell(points.cell(i));
        }
      } else {
        add_point(points.point(i), points.cell(i), false);
      }
    }
  }

 private:
  /// Beyond the tree; its ray may still end at max_range.
  void add_without_cell(const Eigen::Vector3f& point, bool finite) {
    if (finite && is_beyond(point)) {
      add_beyond(point, Eigen::Vector3i::Constant(no_cell), false);
    } else {
      ++out_.counts.dropped_invalid;
    }
  }

  void add_cell(const Eigen::Vector3i& cell) {
    if (cell == last_cell_) {
      ++*last_count_;
      return;
    }
    last_cell_ = cell;
    const bool repeated = !(max_range_ > 0.0 ? out_.seen : out_.hits).set_occupied(cell);
    if (repeated && max_range_ == 0.0) {
      last_count_ = &out_.counts.inserted;
      ++*last_count_;
      return;
    }
    last_count_ = add_point(centre_of(cell), cell, repeated);
  }

  /// A return within range blocks its voxel, wherever the centre lies that its ray ends at.
  void add_safe_cell(const Eigen::Vector3f& point, const Eigen::Vector3i& cell) {
    const bool is_near = !is_beyond(point);
    ++(is_near ? out_.counts.inserted : out_.counts.beyond_range);
    if (is_near && cell != last_hit_) {
      out_.hits.set_occupied(cell);
      last_hit_ = cell;
    }
    if (cell == last_cell_) return;
    last_cell_ = cell;
    if (!out_.seen.set_occupied(cell)) return;
    const Eigen::Vector3f centre = centre_of(cell);
    if (is_near || !is_beyond(centre)) {
      push({centre, reach(centre)}, cell);
      out_.hits.set_occupied(cell);
    } else if (const auto end = end_at_range(centre)) {
      push(*end, cell);
    }
  }

  Eigen::Vector3f centre_of(const Eigen::Vector3i& cell) const {  // as OctoMap's keyToCoord
    return ((cell.cast<double>().array() + 0.5) * tree_.getResolution()).cast<float>();
  }

  /// Returns what counts points like this one.
  std::size_t* add_point(const Eigen::Vector3f& point, const Eigen::Vector3i& cell, bool repeated) {
    if (is_beyond(point)) return add_beyond(point, cell, repeated);
    ++out_.counts.inserted;
    if (repeated) return &out_.counts.inserted;
    push({point, reach(point)}, cell);
    if (cell != last_hit_) out_.hits.set_occupied(cell);
    last_hit_ = cell;
    return &out_.counts.inserted;
  }

  std::size_t* add_beyond(const Eigen::Vector3f& point, const Eigen::Vector3i& cell, bool repeated) {
    const auto end = end_at_range(point);
    std::size_t* const count = end ? &out_.counts.beyond_range : &out_.counts.dropped_invalid;
    ++*count;
    if (end && !repeated) push(*end, cell);
    return count;
  }

  /// Where the ray of a point beyond range ends; nothing outside of the tree.
  std::optional<RayEnd> end_at_range(const Eigen::Vector3f& point) const {
    const point3d way = point3d(point.x(), point.y(), point.z()) - origin_;
    const point3d end = origin_ + way.normalized() * static_cast<float>(max_range_);
    if (!tree_.cell({end.x(), end.y(), end.z()})) return std::nullopt;
    return RayEnd{{end.x(), end.y(), end.z()}};
  }

  void push(const RayEnd& end, const Eigen::Vector3i& cell) {
    out_.ends.push_back(end);
    if (insertion_.discretize) out_.cells.push_back(cell);
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
  point3d origin_;
  double max_range_;
  const ScanInsertion& insertion_;
  ChosenEnds& out_;
  Eigen::Vector3i last_cell_ = Eigen::Vector3i::Constant(no_cell), last_hit_ = last_cell_;
  std::size_t* last_count_ = nullptr;
};

/// Adds to the first share those ends of another one that it does not have yet.
void join(const ScanInsertion& insertion, double max_range, ChosenEnds& other, ChosenEnds& first) {
  if (insertion.discretize) {
    ScanGrid& seen = max_range > 0.0 ? first.seen : first.hits;
    for (std::size_t i = 0; i < other.ends.size(); ++i) {
      const Eigen::Vector3i& cell = other.cells[i];
      if (cell.x() == no_cell || seen.set_occupied(cell)) first.ends.push_back(other.ends[i]);
    }
  } else {
    first.ends.insert(first.ends.end(), other.ends.begin(), other.ends.end());
  }
  for (const ScanTile* from : other.hits.tiles()) {
    ScanTile& to = first.hits.tile(from->corner);
    for (std::size_t i = 0; i < ScanTile::words; ++i) to.occupied[i] |= from->occupied[i];
  }
  first.counts.inserted += other.counts.inserted;
  first.counts.beyond_range += other.counts.beyond_range;
  first.counts.dropped_invalid += other.counts.dropped_invalid;
}

/// The rays that met nothing: to where they end, or to max_range.
void add_clear_rays(const FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                    const ScanInsertion& insertion, ScanRays& rays, ScanCounts& counts) {
  if (scan.clear_to.empty()) return;
  ScanFilter ends = filter;
  ends.thin_to = 0.0;
  ends.outlier_neighbours = 0;
  const FilteredPoints kept =
      filter_points({scan.time, scan.sensor, scan.map_from_sensor, scan.clear_to}, ends);
  for (const Eigen::Vector3f& point : kept.points) {
    const Eigen::Vector3d way = point.cast<double>() - kept.origin;
    const double length = way.norm();
    const double used = filter.max_range > 0.0 ? std::min(filter.max_range, length) : length;
    const Eigen::Vector3f end = (kept.origin + (length > 0.0 ? used / length : 0.0) * way).cast<float>();
    if (!tree.cell(end.cast<double>())) continue;
    const bool is_safe = insertion.integration == Integration::safe;
    const double reach = is_safe ? std::max(0.0, used - insertion.margins.trim(used)) : used;
    rays.ends.push_back({end, static_cast<float>(reach)});
    ++counts.cleared;
  }
}

/// Points for which one ray stands are hits as it is: their voxels are blocked, and no ray frees them.
void add_thinned_hits(const FusedTree& tree, const FilteredPoints& kept, double max_range, ScanGrid& hits) {
  for (const Eigen::Vector3f& point : kept.thinned) {
    const Eigen::Vector3d at = point.cast<double>();
    if (max_range > 0.0 && (at - kept.origin).norm() > max_range) continue;
    if (const auto cell = tree.cell(at)) hits.set_occupied(*cell);
  }
}

/// Marks the voxels of what is no hit, as it may be the robot or a hand.
void mark_taken_out(const FusedTree& tree, const Scan& scan, const FilteredPoints& kept, ScanGrid& grid) {
  const auto mark = [&](const Eigen::Vector3d& point) {
    if (const auto cell = tree.cell(point)) grid.set_occupied(*cell);
  };
  for (const Eigen::Vector3f& point : scan.taken_out) mark(scan.map_from_sensor * point.cast<double>());
  for (const Eigen::Vector3f& point : kept.in_bodies) mark(point.cast<double>());
}

/// True when the filter keeps every point, so that scans need not go through filter_points.
bool keeps_all(const ScanFilter& filter) {
  return filter.min_range == 0.0 && filter.thin_to == 0.0 && filter.crop.isEmpty() && filter.bodies.empty() &&
         filter.outlier_neighbours == 0 && std::isfinite(filter.max_range) && filter.max_range >= 0.0;
}

/// Where the scan's surface goes on between its hits. @param kept null: all points of the scan
void find_gaps(const FusedTree& tree, const Scan& scan, const FilteredPoints* kept,
               const ScanInsertion& insertion, ScanWorkspace& workspace) {
  const GapSearch search{scan.map_from_sensor, tree.getResolution(), insertion.margins};
  if (kept != nullptr) {
    const Eigen::Isometry3d sensor_from_map = scan.map_from_sensor.inverse(Eigen::Isometry);
    workspace.ways.clear();
    for (const Eigen::Vector3f& point : kept->points)
      workspace.ways.push_back((sensor_from_map * point.cast<double>()).cast<float>());
  }
  workspace.gaps =
      &workspace.surface.find(kept != nullptr ? workspace.ways : scan.points, scan.clear_to, search);
}

}  // namespace

ScanRays& choose_rays(const FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                      const ScanInsertion& insertion, ScanWorkspace& workspace, ScanCounts& counts) {
  workspace.grid.clear();
  workspace.taken_out.clear();
  workspace.chosen.ends.clear();
  workspace.gaps = nullptr;
  counts = {};
  const bool whole = keeps_all(filter);
  const FilteredPoints kept = whole ? FilteredPoints{} : filter_points(scan, filter);
  const Eigen::Vector3d origin = scan.map_from_sensor.translation();
  workspace.chosen.origin = origin.cast<float>();
  if (!scan.map_from_sensor.matrix().allFinite() || !tree.cell(workspace.chosen.origin.cast<double>())) {
    counts.dropped_invalid = scan.points.size();
    counts.origin_invalid = true;
    return workspace.chosen;
  }
  if (!is_rotation(scan.map_from_sensor.linear(), 1e-4))
    throw std::invalid_argument(
        "scan: map_from_sensor is no rigid pose: expected a rotation without scale or mirror");
  const std::vector<Eigen::Vector3f>& points = whole ? scan.points : kept.points;
  const Eigen::Isometry3d pose = whole ? scan.map_from_sensor : Eigen::Isometry3d::Identity();
  const auto workers = static_cast<std::size_t>(insertion.threads);
  std::vector<ChosenEnds>& shares = workspace.shares;
  shares.resize(workers);
  std::swap(shares[0].hits, workspace.grid);
  std::swap(shares[0].ends, workspace.chosen.ends);
  parallel(workers, [&](std::size_t worker) {
    ChosenEnds& share = shares[worker];
    share.clear();
    EndChooser chooser(tree, workspace.chosen.origin, filter.max_range, insertion, share);
    PointBatch batch;
    const std::size_t last = points.size() * (worker + 1) / workers;
    for (std::size_t at = points.size() * worker / workers; at < last; at += PointBatch::size) {
      const std::size_t count = std::min(PointBatch::size, last - at);
      place_points(points.data() + at, count, pose, 1.0 / tree.getResolution(), insertion.instructions,
                   batch);
      chooser.add(batch, count);
    }
  });
  for (std::size_t i = 1; i < workers; ++i) join(insertion, filter.max_range, shares[i], shares[0]);
  counts = shares[0].counts;
  counts.dropped_invalid += kept.dropped_invalid;
  counts.dropped_filter = kept.dropped_filter;
  std::swap(shares[0].hits, workspace.grid);
  std::swap(shares[0].ends, workspace.chosen.ends);
  if (insertion.integration == Integration::safe)
    add_thinned_hits(tree, kept, filter.max_range, workspace.grid);
  if (scan.has_hits_only) {
    workspace.chosen.ends.clear();
    return workspace.chosen;
  }
  add_clear_rays(tree, scan, filter, insertion, workspace.chosen, counts);
  if (insertion.integration == Integration::safe) {
    mark_taken_out(tree, scan, kept, workspace.taken_out);
    find_gaps(tree, scan, whole ? nullptr : &kept, insertion, workspace);
  }
  return workspace.chosen;
}

namespace {

/// What of the rays counts, beside what the scan hits and what the map knows.
void spare_and_weigh(FusedTree& tree, const ScanInsertion& insertion, ScanEvidence* evidence,
                     ScanWorkspace& workspace) {
  ScanGrid& grid = workspace.grid;
  const SafeMargins& margins = insertion.margins;
  const double resolution = tree.getResolution();
  const ScanAgreement& agreement = tree.agreement();
  const bool is_in_doubt = static_cast<double>(agreement.called_free) >
                           margins.most_called_free * static_cast<double>(agreement.looked_up);
  const bool weighs = evidence != nullptr && margins.most_called_free < 1.0 && is_in_doubt;
  const SurfaceMargins surface{growth_of(margins.band, resolution), clear_growth_of(margins.band, resolution),
                               weighs};
  spare_surfaces(grid, surface, insertion.threads);
  if (workspace.gaps != nullptr) {
    // One look in four between hits counts against what is occupied: what left before a sensor that stands
    // still is forgotten in the end, and what stands is hit again before.
    const bool counts = evidence != nullptr && evidence->contested.count_scan() % 4 == 3;
    spare_gaps(*workspace.gaps, counts ? &tree : nullptr, grid);
  }
  spare_around(workspace.taken_out, surface, grid, insertion.threads);
  if (weighs) evidence->contested.weigh(tree, grid, insertion.threads);
  if (evidence != nullptr && !workspace.chosen.ends.empty())  // else nobody knows from where it looked
    evidence->grazed.weigh(tree, workspace.chosen.origin.cast<double>(), grid, insertion.threads);
}

/// What the tree may take for a scan, where voxels are so fine that rays lie apart in them.
void require_memory_for(const ScanGrid& grid) {
  constexpr std::size_t small = 4096;
  if (grid.tile_count() > small) require_memory(grid.tree_bytes(), "the voxels of a scan");
}

}  // namespace

ScanCounts insert_scan(FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                       const ScanInsertion& insertion, ScanWorkspace& workspace, ScanEvidence* evidence) {
  if (!(filter.min_range >= 0.0) || !(filter.max_range >= 0.0) ||
      (filter.max_range > 0.0 && filter.min_range > filter.max_range))
    throw std::invalid_argument("scan filter: expected 0 <= min_range <= max_range, metres, got " +
                                short_text(filter.min_range) + " and " + short_text(filter.max_range));
  ScanCounts counts;
  ScanAgreement agreement;
  try {
    const ScanRays& rays = choose_rays(tree, scan, filter, insertion, workspace, counts);
    agreement = compare_hits(tree, workspace.grid);
    cast_rays(rays, tree.getResolution(), insertion.threads, insertion.instructions, workspace.rays,
              workspace.grid);
    require_memory_for(workspace.grid);
  } catch (...) {
    workspace = {};  // windows that were left half read hold marks of this scan
    malloc_trim(0);
    throw;
  }
  tree.add_agreement(agreement);
  if (insertion.integration == Integration::safe) spare_and_weigh(tree, insertion, evidence, workspace);
  tree.update(workspace.grid, insertion.integration, insertion.threads);
  return counts;
}

}  // namespace clearway
