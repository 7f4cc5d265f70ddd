#include "apps/pages/drawn_voxels.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace clearway {
namespace {

constexpr std::array<VoxelState, 4> drawn_states = {VoxelState::painted, VoxelState::occupied,
                                                    VoxelState::conflict, VoxelState::seen_free};

/// Gathers the leaves of one state, of a block of the octree at a time in single voxels and of the rest in
/// cells that are coarse enough for `most_bricks`.
class Gathered {
 public:
  Gathered(VoxelState state, double resolution, bool any) {
    voxels_.state = to_string(state);
    voxels_.any = any || is_drawn_where_any(voxels_.state);
    voxels_.size = resolution;
  }

  void add(const MapLeaf& leaf) {
    const int level = std::countr_zero(static_cast<unsigned>(leaf.edge));
    const VoxelBricks::Cell low{leaf.corner.x() + kOriginVoxel, leaf.corner.y() + kOriginVoxel,
                                leaf.corner.z() + kOriginVoxel};
    const std::uint64_t block = VoxelBricks::code_of(low) >> (3 * block_level);
    if (block != block_) finish_block();
    block_ = block;
    fine_.add(low, level);
    voxels_.count += VoxelBricks::volume(level);
  }

  PageVoxels take(std::uint64_t most_faces) {
    finish_block();
    voxels_.cells.sort();
    while (count_faces(voxels_.cells) > most_faces && voxels_.cells.cell_level() < block_level)
      voxels_.cells.coarsen(voxels_.any);
    return std::move(voxels_);
  }

 private:
  static constexpr int block_level = 8;
  static constexpr std::size_t most_bricks = 400'000;

  void finish_block() {
    fine_.sort();
    while (fine_.cell_level() < voxels_.cells.cell_level()) fine_.coarsen(voxels_.any);
    voxels_.cells.append(fine_);
    fine_ = {};
    if (voxels_.cells.bricks() <= most_bricks || voxels_.cells.cell_level() + 3 >= block_level) return;
    voxels_.cells.sort();
    voxels_.cells.coarsen(voxels_.any);
  }

  PageVoxels voxels_;
  VoxelBricks fine_;
  std::uint64_t block_ = 0;
};

}  // namespace

std::vector<PageVoxels> drawn_voxels(const MapLeaves& map, std::uint64_t most_faces, bool shows_difference,
                                     const std::function<void(const MapLeaf&)>& also) {
  std::vector<Gathered> gathered;
  for (const VoxelState state : drawn_states)
    gathered.emplace_back(state, map.resolution(), shows_difference);
  map.visit([&](const MapLeaf& leaf) {
    if (also) also(leaf);
    const auto at = std::find(drawn_states.begin(), drawn_states.end(), leaf.state);
    if (at != drawn_states.end()) gathered[static_cast<std::size_t>(at - drawn_states.begin())].add(leaf);
  });
  std::vector<PageVoxels> drawn;
  for (Gathered& each : gathered) drawn.push_back(each.take(most_faces));
  return drawn;
}

}  // namespace clearway
