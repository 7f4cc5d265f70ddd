#include "mapping/maps/ray_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// The cells that a ray passes, one after the other.
class CellWalk {
 public:
  CellWalk(const Eigen::Vector3d& origin, const Eigen::Vector3d& unit, const Eigen::Vector3i& start,
           double resolution)
      : origin_(origin), unit_(unit), cell_(start), resolution_(resolution) {}

  const Eigen::Vector3i& cell() const { return cell_; }

  /// Distance at which the ray leaves the cell.
  double exit() const { return exit_by(exit_axis()); }

  /// To the next cell; false at the end of the key range.
  bool step() {
    const int axis = exit_axis();
    cell_[axis] += unit_[axis] > 0.0 ? 1 : -1;
    return cell_[axis] >= -32768 && cell_[axis] <= 32767;
  }

 private:
  double exit_by(int axis) const {
    if (unit_[axis] == 0.0) return never;
    const double side = (cell_[axis] + (unit_[axis] > 0.0 ? 1 : 0)) * resolution_;
    return std::max(0.0, (side - origin_[axis]) / unit_[axis]);
  }
  int exit_axis() const {
    int nearest = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (exit_by(axis) < exit_by(nearest)) nearest = axis;
    }
    return nearest;
  }

  Eigen::Vector3d origin_, unit_;
  Eigen::Vector3i cell_;
  double resolution_;
};

/// Distance at which a ray leaves a box, which it may reach from outside; below 0 when it never does.
double leaves(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& unit) {
  double enter = 0.0, exit = never;
  for (int axis = 0; axis < 3; ++axis) {
    if (unit[axis] == 0.0) {
      if (origin[axis] < box.min()[axis] || origin[axis] > box.max()[axis]) return -1.0;
      continue;
    }
    const double a = (box.min()[axis] - origin[axis]) / unit[axis];
    const double b = (box.max()[axis] - origin[axis]) / unit[axis];
    enter = std::max(enter, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  return enter <= exit ? exit : -1.0;
}

void lengthen(std::vector<RayRun>& runs, VoxelState state, double from, double to) {
  if (!(to > from)) return;  // a corner that the ray only touches
  if (!runs.empty() && runs.back().state == state) {
    runs.back().to = to;
  } else {
    runs.push_back({state, from, to});
  }
}

}  // namespace

RayReport ray_states(const Snapshot& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const auto start = map.tree().cell(origin);
  if (!start || !direction.allFinite() || !(direction.norm() > 0.0) || !std::isfinite(direction.norm())) {
    throw std::invalid_argument(
        "ray: expected an origin inside the map's key range and a direction that is finite and not 0");
  }
  const Eigen::Vector3d unit = direction.normalized();
  RayReport report;
  const double end = map.bounds().isEmpty() ? -1.0 : leaves(map.bounds(), origin, unit);
  CellWalk walk(origin, unit, *start, map.resolution());
  double at = 0.0;
  while (at < end) {
    CellCube cube;
    const FusedNode* leaf = map.tree().find_leaf(walk.cell(), cube);
    const VoxelState state = leaf == nullptr ? VoxelState::unknown : map.tree().state(*leaf);
    if (state == VoxelState::occupied || state == VoxelState::conflict) {
      const Eigen::Vector3d center = (walk.cell().cast<double>().array() + 0.5) * map.resolution();
      report.blocked = map.voxel(center);
      break;
    }
    const double exit = std::min(std::max(at, walk.exit()), end);
    lengthen(report.runs, state, at, exit);
    at = exit;
    if (!walk.step()) break;
  }
  report.distance = at;
  return report;
}

}  // namespace clearway
