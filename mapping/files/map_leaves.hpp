#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

/// A cube of voxels of one state: voxels corner ... corner + edge - 1 along each axis, counted from the map's
/// origin, so that it spans [corner, corner + edge] * resolution in metres.
struct MapLeaf {
  VoxelState state = VoxelState::unknown;
  std::uint16_t volumes = 0;  ///< painted volumes (bit i = volume i) that contain it
  Eigen::Vector3i corner = Eigen::Vector3i::Zero();
  int edge = 1;
  bool observed = false;  ///< some ray ended in it or passed through it
  float log_odds = 0.0F;  ///< of the sensors only; meaningless when not observed
};

/// A map that one goes through leaf by leaf, as often as one likes: to look at maps that are larger than the
/// memory. What asks for places (states at points, clearances) needs a Snapshot.
class MapLeaves {
 public:
  /// Of a map in memory.
  explicit MapLeaves(Snapshot map);
  /// Of a map file or folder, as load_map takes them. Of .ot and .bt files no tree is made: the memory for it
  /// does not grow with the map (look times do, see SeenStamps). @param cloud_resolution as of load_map
  /// @throws as load_map.
  static MapLeaves in_file(const std::filesystem::path& path, std::optional<double> cloud_resolution = {});

  /// How another map of the same resolution differs, in states: `conflict` is blocked in the other
  /// alone, `painted` is blocked here alone, `occupied` in both; `seen_free` has another state otherwise.
  /// What has the same is left out. @throws std::invalid_argument for another resolution.
  static MapLeaves difference(const Snapshot& here, const Snapshot& there);

  double resolution() const { return about_.resolution(); }  ///< metres
  const std::vector<PaintedVolume>& volumes() const { return about_.volumes(); }
  VoxelCounts counts() const { return counts_; }
  Eigen::AlignedBox3d bounds() const;  ///< of all stored leaves' cubes; empty for an empty map
  /// Where to look first: `bounds` without a few far returns of a sensor, which else leave a map a dot in its
  /// picture. All that is painted or in conflict is inside. Of what is occupied, at most 0.2 % at each end of
  /// an axis is left out, and only where it lies farther away than the rest is long; of what is seen free,
  /// slabs of 16 voxels that hold less than 1 % of what the fullest one holds. An axis is cut only where
  /// `bounds` is over three times as long as the rest.
  /// Goes through the map at the first call; not to be called by several threads at once.
  Eigen::AlignedBox3d main_bounds() const;
  std::size_t tree_bytes() const { return tree_bytes_; }  ///< of memory, of the map as a tree
  const std::string& sha256() const { return sha256_; }   ///< of the file; empty for a map in memory
  /// All that is known of the map beside its voxels, for the functions that report it; where its leaves come
  /// from a file, it has no voxels.
  const Snapshot& about() const { return about_; }

  /// Calls `visit` for each stored leaf with a state other than unknown; of a snapshot and of our files in
  /// the tree's order. @throws DamagedFile when the file was overwritten since.
  void visit(const std::function<void(const MapLeaf&)>& visit) const;

 private:
  using Visit = std::function<void(const MapLeaf&)>;
  MapLeaves(Snapshot about, std::function<void(const Visit&)> walk);
  void survey();
  Eigen::AlignedBox3d metres(const Eigen::AlignedBox3i& cells) const;

  Snapshot about_;
  std::function<void(const Visit&)> walk_;  ///< through all stored leaves
  VoxelCounts counts_;
  Eigen::AlignedBox3i cells_;
  mutable std::optional<Eigen::AlignedBox3i> main_cells_;  ///< once it was asked for
  unsigned painted_ = 0;                                   ///< masks of all voxels, united
  std::size_t leaves_ = 0, tree_bytes_ = 0;
  std::string sha256_;
};

}  // namespace clearway
