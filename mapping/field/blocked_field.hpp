#pragma once

#include <cmath>
#include <cstddef>
#include <memory>

#include "mapping/field/blocked_space.hpp"
#include "mapping/field/distance_tiles.hpp"

namespace clearway {

class FusedTree;
class SeenStamps;
struct FieldLookUp;

/// A block of voxel cells: cell i spans [i, i + 1] * resolution on each axis, as OctoMap's keys less 32768.
struct FieldRegion {
  Eigen::Vector3i first = Eigen::Vector3i::Zero();
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  double resolution = 0.0;
  double max_distance = 0.0;  ///< as asked, but at most 89 voxels

  bool contains(const Eigen::Vector3i& cell) const {
    return ((cell - first).array() >= 0).all() && ((cell - first).array() < size.array()).all();
  }
};

/// What the derived structures of one snapshot may take together, bytes.
constexpr std::size_t field_memory_limit = std::size_t{1} << 30U;

/// Snaps a metric region outwards to cells.
/// @throws std::invalid_argument when it is empty, not finite, too far away or too large for the memory
/// limit,
///         or when max_distance is not > 0.
FieldRegion field_region(const Eigen::AlignedBox3d& region, double resolution, double max_distance,
                         std::size_t memory_limit = field_memory_limit);

/// Memory of the field of a region at most, bytes: 3.2 a cell, those of byte_field() included. As much as
/// that only where all of it is looked at.
std::size_t field_bytes(const FieldRegion& region);

/// BlockedSpace as one 16-bit squared distance per cell; 0 marks a blocked voxel. What is looked at is
/// computed then, and nothing else; the answers are those of a field that was computed as a whole.
class BlockedField final : public BlockedSpace {
 public:
  /// From nothing.
  /// @param seen when the tree's voxels were last seen; null: not known
  /// @throws std::invalid_argument as require_seen_within does
  BlockedField(const FusedTree& tree, const Requirement& requirement, const FieldRegion& cells,
               const SeenStamps* seen = nullptr);

  /// The field of a newer version of the tree: equal, cell for cell, to one made from nothing. It shares with
  /// `before` what did not change.
  /// @param tree_before is what `before` was made of, with the same occupancy threshold.
  BlockedField(const FusedTree& tree, const FusedTree& tree_before, const BlockedField& before,
               const SeenStamps* seen = nullptr);

  const FieldRegion& cells() const { return cells_; }
  const std::shared_ptr<const DistanceTiles>& distances() const { return tiles_; }
  bool is_outside_blocked() const { return outside_blocked_; }

  const Requirement& requirement() const override { return requirement_; }
  double resolution() const override { return cells_.resolution; }
  double max_distance() const override { return cells_.max_distance; }
  const Eigen::AlignedBox3d& region() const override { return box_; }
  std::size_t blocked_count() const override { return tiles_->blocked().count(); }

  void renew() const override { tiles_->renew(); }

  bool is_blocked(const Eigen::Vector3d& point) const override;
  bool is_voxel_blocked(const Eigen::Vector3i& voxel) const override;
  double clearance(const Eigen::Vector3d& point) const override;
  double coarse_clearance(const Eigen::Vector3d& point) const override;
  void clearances(const PointArrays& points, std::span<double> out) const override;
  void coarse_clearances(const PointArrays& points, std::span<double> out) const override;

  /// The same with the given instruction set, which the machine must support.
  void clearances(const PointArrays& points, std::span<double> out, InstructionSet vectors) const;
  void coarse_clearances(const PointArrays& points, std::span<double> out, InstructionSet vectors) const;

  const ByteField& byte_field() const override;

  std::array<int, 7> squared_around(const Eigen::Vector3i& voxel) const override;
  NearestBlocked nearest(const Eigen::Vector3d& point, double limit) const override;
  RayHit cast_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                  double max_range) const override;
  bool visit_blocked(const Eigen::AlignedBox3d& box,
                     const std::function<bool(const Eigen::Vector3d&)>& visit) const override;
  bool visit_surface(const Eigen::AlignedBox3d& box,
                     const std::function<bool(const Eigen::Vector3d&)>& visit) const override;

 private:
  class Search;
  struct Row;
  std::uint16_t squared(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i at = cell - cells_.first;
    return tiles_->squared(at.x(), at.y(), at.z());
  }
  Eigen::Vector3d center(const Eigen::Vector3i& cell) const {
    return (cell.cast<double>().array() + 0.5) * cells_.resolution;
  }
  Eigen::Vector3i cell_near(const Eigen::Vector3d& point) const;  ///< of the region, nearest to the point
  double bound_from_cells(const Eigen::Vector3d& inside) const;
  double bound_from_neighbours(const Eigen::Vector3d& inside) const;
  FieldLookUp look_up() const;
  double distance_to_border(const Eigen::Vector3d& inside, int& axis, bool& upper) const;
  NearestBlocked nearest_outside(const Eigen::Vector3d& point) const;
  NearestBlocked describe(const Eigen::Vector3d& point, const Eigen::Vector3i& voxel) const;
  Row row(int lane, int z) const;

  Requirement requirement_;
  bool outside_blocked_;
  FieldRegion cells_;
  double inverse_resolution_;
  Eigen::AlignedBox3d box_;
  std::shared_ptr<const DistanceTiles> tiles_;
  struct Bytes;  ///< made at the first look
  std::shared_ptr<Bytes> bytes_;
};

}  // namespace clearway
