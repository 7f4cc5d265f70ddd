#include "mapping/field/blocked_field.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <mutex>

#include "mapping/field/byte_field.hpp"
#include "mapping/field/field_look_up.hpp"
#include "mapping/field/seen_within.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

/// The field is kept half a voxel diagonal beyond max_distance, so that the bound reaches max_distance.
std::uint16_t cap_of(const FieldRegion& region) {
  const double half_voxels = 2.0 * region.max_distance / region.resolution + std::sqrt(3.0);
  return static_cast<std::uint16_t>(std::min(std::ceil(half_voxels * half_voxels), double{largest_cap}));
}

using Corners = std::array<std::uint16_t, 8>;

/// The squared distances of the cells low and high, and of those between; x changes fastest.
Corners corners_of(const DistanceTiles& tiles, int low_x, int low_y, int low_z, int high_x, int high_y,
                   int high_z) {
  const int lane = low_x >> 5, x = low_x & 31, next = high_x & 31;
  const std::uint16_t* a = tiles.line(lane, low_y, low_z);
  const std::uint16_t* b = tiles.line(lane, high_y, low_z);
  const std::uint16_t* c = tiles.line(lane, low_y, high_z);
  const std::uint16_t* d = tiles.line(lane, high_y, high_z);
  Corners corners{a[x], 0, b[x], 0, c[x], 0, d[x], 0};
  if (lane != high_x >> 5) {
    a = tiles.line(lane + 1, low_y, low_z);
    b = tiles.line(lane + 1, high_y, low_z);
    c = tiles.line(lane + 1, low_y, high_z);
    d = tiles.line(lane + 1, high_y, high_z);
  }
  corners[1] = a[next];
  corners[3] = b[next];
  corners[5] = c[next];
  corners[7] = d[next];
  return corners;
}

}  // namespace

namespace {

/// The cells of a region, from a copy of the tree, which shares its nodes.
struct TreeCells {
  std::shared_ptr<const FusedTree> tree;
  Requirement requirement;
  FieldRegion cells;

  DistanceTiles::ReadCells read() const {
    return [own = *this](const DistanceTiles::Box& box, BlockedCells& blocked) {
      read_blocked_cells(*own.tree, own.requirement, own.cells.first, box.low, box.high, blocked);
    };
  }
  DistanceTiles::VisitBlocked visit() const {
    return [own = *this](const std::function<void(const CellBox&)>& visit) {
      visit_blocked_boxes(*own.tree, own.requirement, own.cells.first, own.cells.size, DistanceTiles::ny,
                          visit);
    };
  }
};

}  // namespace

struct BlockedField::Bytes {
  std::once_flag made;
  std::unique_ptr<const ByteField> field;
};

BlockedField::BlockedField(const FusedTree& tree, const Requirement& requirement, const FieldRegion& cells,
                           const SeenStamps* seen)
    : requirement_(requirement),
      outside_blocked_(!allows(requirement, VoxelState::unknown, 0)),
      cells_(cells),
      inverse_resolution_(1.0 / cells.resolution),
      box_((cells.first.cast<double>() * cells.resolution).eval(),
           ((cells.first + cells.size).cast<double>() * cells.resolution).eval()),
      bytes_(std::make_shared<Bytes>()) {
  require_seen_within(requirement, seen);
  if (requirement.seen_within > 0.0) {
    tiles_ = std::make_shared<const DistanceTiles>(
        blocked_cells(tree, seen, requirement, cells.first, cells.size), cap_of(cells));
  } else {
    const TreeCells of_tree{std::make_shared<const FusedTree>(tree), requirement, cells};
    tiles_ =
        std::make_shared<const DistanceTiles>(cells.size, cap_of(cells), of_tree.read(), of_tree.visit());
  }
}

BlockedField::BlockedField(const FusedTree& tree, const FusedTree& tree_before, const BlockedField& before,
                           const SeenStamps* seen)
    : requirement_(before.requirement_),
      outside_blocked_(before.outside_blocked_),
      cells_(before.cells_),
      inverse_resolution_(before.inverse_resolution_),
      box_(before.box_),
      bytes_(std::make_shared<Bytes>()) {
  if (requirement_.seen_within > 0.0) {  // voxels age where the tree stays as it is
    tiles_ = std::make_shared<const DistanceTiles>(
        *before.tiles_, blocked_cells(tree, seen, requirement_, cells_.first, cells_.size));
    return;
  }
  const auto follow = [&](BlockedCells& cells) {
    return follow_blocked_cells(tree, requirement_, cells_.first, tree_before, cells);
  };
  const TreeCells of_tree{std::make_shared<const FusedTree>(tree), requirement_, cells_};
  tiles_ = std::make_shared<const DistanceTiles>(*before.tiles_, follow, of_tree.read(), of_tree.visit());
}

const ByteField& BlockedField::byte_field() const {
  std::call_once(bytes_->made, [this] { bytes_->field = std::make_unique<ByteField>(*this); });
  return *bytes_->field;
}

bool BlockedField::is_blocked(const Eigen::Vector3d& point) const {
  if (!point.allFinite()) return true;
  const Eigen::Array3d scaled = (point * inverse_resolution_).array().floor();
  const Eigen::Array3d offset = scaled - cells_.first.cast<double>().array();
  if ((offset < 0.0).any() || (offset >= cells_.size.cast<double>().array()).any()) return outside_blocked_;
  const Eigen::Vector3i at = offset.cast<int>();
  return tiles_->is_blocked(at.x(), at.y(), at.z());
}

Eigen::Vector3i BlockedField::cell_near(const Eigen::Vector3d& point) const {
  const Eigen::Array3d first = cells_.first.cast<double>().array();
  const Eigen::Array3d last = first + cells_.size.cast<double>().array() - 1.0;
  return (point * inverse_resolution_).array().floor().max(first).min(last).matrix().cast<int>();
}

/// max over the 8 surrounding cells of D(centre) - |point - centre|: each is a lower bound, for D is
/// 1-Lipschitz.
double BlockedField::bound_from_cells(const Eigen::Vector3d& inside) const {
  std::array<int, 3> low{}, high{};
  double gaps[3][2];  // from the point to their centres, in cells, squared
  for (int axis = 0; axis < 3; ++axis) {
    const double at = inside[axis] * inverse_resolution_ - cells_.first[axis];
    const auto i = static_cast<std::size_t>(axis);
    low[i] = std::min(static_cast<int>(std::max(at - 0.5, 0.0)), cells_.size[axis] - 1);
    high[i] = std::min(low[i] + 1, cells_.size[axis] - 1);
    gaps[axis][0] = (at - low[i] - 0.5) * (at - low[i] - 0.5);
    gaps[axis][1] = (at - high[i] - 0.5) * (at - high[i] - 0.5);
  }
  const Corners corners = corners_of(*tiles_, low[0], low[1], low[2], high[0], high[1], high[2]);
  const double* roots = half_roots();
  double best = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const double gap = gaps[0][corner & 1U] + gaps[1][corner >> 1U & 1U] + gaps[2][corner >> 2U];
    best = std::max(best, roots[corners[corner]] - std::sqrt(gap));
  }
  return best * cells_.resolution;
}

/// The exact distance to the blocked cubes among the 27 around the point; others are beyond those cells. So
/// the bound is exact within one voxel of an obstacle, where the field's slack would matter most.
double BlockedField::bound_from_neighbours(const Eigen::Vector3d& inside) const {
  const Eigen::Vector3i cell = cell_near(inside);
  const Eigen::Array3d offset = (inside - center(cell)).array();
  double nearest_squared = (1.5 * cells_.resolution - offset.abs()).minCoeff();
  nearest_squared *= std::max(nearest_squared, 0.0);
  // Gaps to the cells before, of and after the point's own, along each axis.
  Eigen::Array33d gaps;
  for (int axis = 0; axis < 3; ++axis) {
    for (int step = -1; step <= 1; ++step) {
      const double gap =
          std::max(std::abs(offset[axis] - step * cells_.resolution) - 0.5 * cells_.resolution, 0.0);
      gaps(axis, step + 1) = gap * gap;
    }
  }
  const Eigen::Vector3i at = cell - cells_.first;
  for (int z = std::max(at.z() - 1, 0); z <= std::min(at.z() + 1, cells_.size.z() - 1); ++z) {
    for (int y = std::max(at.y() - 1, 0); y <= std::min(at.y() + 1, cells_.size.y() - 1); ++y) {
      const unsigned bits = tiles_->blocked_nearby().around(at.x(), y, z);
      if (bits == 0) continue;
      const double gap = gaps(1, y - at.y() + 1) + gaps(2, z - at.z() + 1);
      for (int x = 0; x < 3; ++x) {
        if ((bits >> x & 1U) != 0) nearest_squared = std::min(nearest_squared, gaps(0, x) + gap);
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
  if (gap_squared == 0.0 && squared(cell_near(point)) == 0) return 0.0;
  double bound = bound_from_cells(inside);
  if (bound < 1.5 * cells_.resolution) bound = std::max(bound, bound_from_neighbours(inside));
  if (outside_blocked_) {
    int axis = 0;
    bool upper = false;
    bound = std::min(bound, distance_to_border(inside, axis, upper));
  }
  // The region is convex: what lies in it is at least as far as Pythagoras says from its nearest point.
  if (gap_squared > 0.0) bound = std::sqrt(bound * bound + gap_squared);
  const double rounding =
      rounding_of_voxel * cells_.resolution + rounding_of_coordinate * point.cwiseAbs().maxCoeff();
  return std::clamp(bound - rounding, 0.0, cells_.max_distance);
}

}  // namespace clearway
