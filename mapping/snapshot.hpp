#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

#include "mapping/field/blocked_space.hpp"
#include "mapping/voxels/eigen_layout.hpp"
#include "mapping/voxels/painted_volume.hpp"
#include "mapping/voxels/voxel_state.hpp"

namespace clearway {

class FusedTree;
class SeenStamps;

/// Voxels of the map by state, at the finest resolution (a pruned leaf counts as all its voxels).
/// `unknown` voxels are not stored and so not counted.
struct VoxelCounts {
  std::size_t painted = 0, seen_free = 0, occupied = 0, conflict = 0;
};

/// Everything known of one voxel.
struct Voxel {
  VoxelState state = VoxelState::unknown;
  std::uint16_t volumes = 0;  ///< painted volumes (bit i = volume i) that contain the voxel
  bool observed = false;      ///< some ray ended in it or passed through it
  double log_odds = 0.0;      ///< of the sensors only; meaningless when not observed
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double size = 0.0;  ///< edge of the leaf that answered, metres (a pruned leaf is larger)
};

/// An immutable view of a map: cheap to copy, safe to read from many threads. Frame: the map frame.
class Snapshot {
 public:
  /// An empty map of 1 m voxels; real ones come from FreeSpaceMap::snapshot() and load_map().
  Snapshot();
  /// @param seen when the voxels were last seen; null: not known
  Snapshot(std::shared_ptr<const FusedTree> tree, std::vector<PaintedVolume> volumes,
           std::shared_ptr<const SeenStamps> seen = nullptr);
  /// The same for a later version of `previous`, whose blocked spaces are then updated where it is asked for
  /// them again, not built anew.
  Snapshot(std::shared_ptr<const FusedTree> tree, std::vector<PaintedVolume> volumes,
           const Snapshot& previous, std::shared_ptr<const SeenStamps> seen = nullptr);
  /// Moving copies, too: what was moved from is still the same map.
  Snapshot(const Snapshot&) = default;
  Snapshot& operator=(const Snapshot&) = default;
  ~Snapshot() = default;

  double resolution() const;                          ///< metres
  const std::vector<PaintedVolume>& volumes() const;  ///< exact spheres; empty for a bare tree
  const FusedTree& tree() const;                      ///< for this floor: its header is not installed
  VoxelCounts counts() const;                         ///< walks the tree once
  /// Whether any voxel has one of these states (but unknown): walks until it has found one.
  bool holds_any(std::initializer_list<VoxelState> states) const;
  /// By how much one look through a voxel lowers its log-odds: that of the map's sensor model, or OctoMap's
  /// for a map that does not store one. A voxel whose log-odds are no lower was seen once, or is as little
  /// known.
  double log_odds_of_a_look() const;
  Eigen::AlignedBox3d bounds() const;  ///< of all stored leaves' cubes; empty for an empty map

  Voxel voxel(const Eigen::Vector3d& point) const;  ///< unknown for a non-finite or far point
  VoxelState state(const Eigen::Vector3d& point) const { return voxel(point).state; }

  /// When voxels were last seen; null: the map does not know (no scan of it had a time).
  const SeenStamps* seen() const;
  /// When the voxel of a point was last seen, in the time of the scans, s: never too late, too early by less
  /// than seen()->period(). None: never, or not known when.
  std::optional<double> last_seen(const Eigen::Vector3d& point) const;

  /// Calls `visit` for each stored leaf with a state other than unknown, in the tree's order.
  void visit_leaves(const std::function<void(const Voxel&)>& visit) const;
  /// The same for those alone whose cubes meet `box`, and perhaps some that lie within a voxel of it: takes
  /// time in proportion to their number. An end of the box that is not a number does not limit it.
  void visit_leaves(const Eigen::AlignedBox3d& box, const std::function<void(const Voxel&)>& visit) const;

  /// Bit mask of the volumes whose critical parts include `part`; 0 when none does.
  std::uint16_t volumes_of_part(const std::string& part) const;

  /// The blocked voxels and distance field of `requirement` inside `region` (snapped outwards: its low corner
  /// to cubes of 8 voxels of the tree, its high one to voxels). What lies beyond has no effect on distances:
  /// choose a region that is larger by `max_distance` than where they are asked for. Built once for equal
  /// arguments and shared afterwards.
  /// @param max_distance where the field is truncated, metres, > 0.
  /// @throws std::invalid_argument when the region is empty or its field would exceed the memory limit (the
  ///         sentence says which size would fit), or when `requirement` asks for times that the map does not
  ///         know, or under another policy than known_free.
  std::shared_ptr<const BlockedSpace> blocked_space(const Requirement& requirement,
                                                    const Eigen::AlignedBox3d& region,
                                                    double max_distance) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace clearway
