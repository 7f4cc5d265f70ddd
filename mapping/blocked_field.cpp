#include "mapping/blocked_field.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "mapping/fused_tree.hpp"

namespace clearway {
namespace {

/// The field is kept half a voxel diagonal beyond max_distance, so that the bound reaches max_distance.
std::uint16_t cap_of(const FieldRegion& region) {
  const double half_voxels = 2.0 * region.max_distance / region.resolution + std::sqrt(3.0);
  return static_cast<std::uint16_t>(std::min(std::ceil(half_voxels * half_voxels), double{largest_cap}));
}

}  // namespace

BlockedField::BlockedField(const FusedTree& tree, const Requirement& requirement, const FieldRegion& cells)
    : requirement_(requirement),
      outside_blocked_(!allows(requirement, VoxelState::unknown, 0)),
      cells_(cells),
      inverse_resolution_(1.0 / cells.resolution),
      box_((cells.first.cast<double>() * cells.resolution).eval(),
           ((cells.first + cells.size).cast<double>() * cells.resolution).eval()),
      field_(cells.size.x(), cells.size.y(), cells.size.z(), cap_of(cells)) {
  mark_blocked(tree);
  transform_distances(field_);
}

/// Cells become 0 where the requirement forbids the voxel, cap elsewhere.
void BlockedField::mark_blocked(const FusedTree& tree) {
  const Eigen::Vector3i& size = cells_.size;
  const auto fill = [&](const Eigen::Vector3i& low, const Eigen::Vector3i& high, std::uint16_t value) {
    for (int z = low.z(); z < high.z(); ++z) {
      for (int y = low.y(); y < high.y(); ++y) {
        std::fill_n(&field_.squared[field_.index(low.x(), y, z)], high.x() - low.x(), value);
      }
    }
  };
  if (outside_blocked_) fill(Eigen::Vector3i::Zero(), size, 0);
  const Eigen::Vector3i last = cells_.first + size - Eigen::Vector3i::Ones();
  tree.visit_leaves(cells_.first, last, [&](const FusedNode& node, const CellCube& cube) {
    const bool allowed = allows(requirement_, tree.state(node), node.painted());
    if (allowed != outside_blocked_) return;  // as it was filled
    const Eigen::Vector3i low = (cube.corner - cells_.first).cwiseMax(0);
    const Eigen::Vector3i high =
        (cube.corner.array() + cube.edge - cells_.first.array()).matrix().cwiseMin(size);
    fill(low, high, allowed ? field_.cap : std::uint16_t{0});
  });
  blocked_count_ = static_cast<std::size_t>(std::count(field_.squared.begin(), field_.squared.end(), 0));
}

bool BlockedField::is_blocked(const Eigen::Vector3d& point) const {
  if (!point.allFinite()) return true;
  const Eigen::Array3d scaled = (point * inverse_resolution_).array().floor();
  const Eigen::Array3d offset = scaled - cells_.first.cast<double>().array();
  if ((offset < 0.0).any() || (offset >= cells_.size.cast<double>().array()).any()) return outside_blocked_;
  return squared(scaled.cast<int>()) == 0;
}

Eigen::Vector3i BlockedField::cell_near(const Eigen::Vector3d& point) const {
  const Eigen::Array3d first = cells_.first.cast<double>().array();
  const Eigen::Array3d last = first + cells_.size.cast<double>().array() - 1.0;
  return (point * inverse_resolution_).array().floor().max(first).min(last).matrix().cast<int>();
}

/// max over the 8 surrounding cells of D(centre) - |point - centre|: each is a lower bound, for D is
/// 1-Lipschitz.
double BlockedField::bound_from_cells(const Eigen::Vector3d& inside) const {
  const Eigen::Vector3d half_cell = Eigen::Vector3d::Constant(0.5 * cells_.resolution);
  const Eigen::Vector3i low = cell_near(inside - half_cell);
  const Eigen::Vector3i last = cells_.first + cells_.size - Eigen::Vector3i::Ones();
  const Eigen::Vector3i high = (low.array() + 1).min(last.array());
  double bound = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i cell(corner & 1U ? high.x() : low.x(), corner & 2U ? high.y() : low.y(),
                               corner & 4U ? high.z() : low.z());
    const double distance = 0.5 * cells_.resolution * std::sqrt(static_cast<double>(squared(cell)));
    if (distance > bound) bound = std::max(bound, distance - (inside - center(cell)).norm());
  }
  return bound;
}

/// The exact distance to the blocked cubes among the 27 around the point; others are beyond those cells. So
/// the bound is exact within one voxel of an obstacle, where the field's slack would matter most.
double BlockedField::bound_from_neighbours(const Eigen::Vector3d& inside) const {
  const Eigen::Vector3i cell = cell_near(inside);
  const Eigen::Array3d offset = (inside - center(cell)).array();
  double nearest_squared = (1.5 * cells_.resolution - offset.abs()).minCoeff();
  nearest_squared *= std::max(nearest_squared, 0.0);
  const Eigen::Vector3i last = cells_.first + cells_.size - Eigen::Vector3i::Ones();
  const Eigen::Vector3i low = (cell.array() - 1).max(cells_.first.array());
  const Eigen::Vector3i high = (cell.array() + 1).min(last.array());
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        if (squared({x, y, z}) != 0) continue;
        const Eigen::Array3d gap =
            ((inside - center({x, y, z})).array().abs() - 0.5 * cells_.resolution).max(0.0);
        nearest_squared = std::min(nearest_squared, gap.square().sum());
      }
    }
  }
  return std::sqrt(nearest_squared);
}

double BlockedField::distance_to_border(const Eigen::Vector3d& inside, int& axis, bool& upper) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double low = inside[i] - box_.min()[i];
    const double high = box_.max()[i] - inside[i];
    if (std::min(low, high) >= nearest) continue;
    nearest = std::min(low, high);
    axis = i;
    upper = high < low;
  }
  return std::max(nearest, 0.0);
}

double BlockedField::clearance(const Eigen::Vector3d& point) const {
  if (!point.allFinite()) return 0.0;
  const Eigen::Vector3d inside = point.cwiseMax(box_.min()).cwiseMin(box_.max());
  const double gap_squared = (point - inside).squaredNorm();
  if (outside_blocked_ && gap_squared > 0.0) return 0.0;
  double bound = bound_from_cells(inside);
  if (bound < 1.5 * cells_.resolution) bound = std::max(bound, bound_from_neighbours(inside));
  if (outside_blocked_) {
    int axis = 0;
    bool upper = false;
    bound = std::min(bound, distance_to_border(inside, axis, upper));
  }
  // The region is convex: what lies in it is at least as far as Pythagoras says from its nearest point.
  if (gap_squared > 0.0) bound = std::sqrt(bound * bound + gap_squared);
  const double rounding = 1e-9 * cells_.resolution + 1e-15 * point.cwiseAbs().maxCoeff();
  return std::clamp(bound - rounding, 0.0, cells_.max_distance);
}

}  // namespace clearway
