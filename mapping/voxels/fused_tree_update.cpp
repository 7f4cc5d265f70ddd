// One descent of the tree per scan: all free and occupied voxels of a ScanGrid at once, with the tree that
// the rule of one voxel (in `compatible` integration OctoMap's updateNode) would make of them one by one.

#include <algorithm>
#include <atomic>
#include <vector>

#include "mapping/system/parallel.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/occupancy_update.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// Updates the nodes of cubes of voxels. A cube of level L has an edge of 2^L voxels; within a tile the cubes
/// of a level are numbered in octree order.
class FusedTree::ScanUpdate {
 public:
  static constexpr int tile_level = 5;

  /// A tile's bits, and what they say of its cubes of 4 x 4 x 4 voxels: one bit each.
  struct Tile {
    /// Takes the occupied bits out of the free ones.
    void read(ScanTile& scan);

    const ScanTile* bits = nullptr;
    std::array<std::uint64_t, 8> free{}, hit{}, full{};  ///< any free, any hit, all free
    bool has_free = false, has_hit = false;
    FusedNode* node = nullptr;  ///< the tile's, when anything may change in it
    bool created = false;       ///< and whether this scan made it
    bool changed = false;
  };

  ScanUpdate(const FusedTree& model, Integration integration)
      : rule_{integration,
              model.prob_hit_log,
              model.prob_miss_log,
              model.clamping_thres_min,
              model.clamping_thres_max,
              model.occ_prob_thres_log} {}

  /// Makes the nodes from `node` (of `level`) down to those of the tiles first..last.
  void reach_tiles(FusedNode& node, int level, bool created, Tile* first, Tile* last);
  /// Prunes the nodes above changed tiles and updates them. True when any changed.
  bool close_above_tiles(FusedNode& node, int level, const Tile* first, const Tile* last);
  /// Updates the voxels of one cube. True when any changed.
  template <int Level>
  bool update_cube(FusedNode& node, bool created, const Tile& tile, unsigned cube);
  /// Nodes made less nodes pruned; wraps round where more were pruned.
  std::size_t nodes() const { return nodes_; }

 private:
  template <int Level>
  static bool any_free(const Tile& tile, unsigned cube) {
    return bits_of<Level>(tile.free, tile.bits->free, cube) != 0;
  }
  template <int Level>
  static bool any_hit(const Tile& tile, unsigned cube) {
    return bits_of<Level>(tile.hit, tile.bits->occupied, cube) != 0;
  }
  template <int Level>
  static bool all_free(const Tile& tile, unsigned cube);
  template <int Level>
  static std::uint64_t bits_of(const std::array<std::uint64_t, 8>& of_words,
                               const std::array<std::uint64_t, 512>& of_voxels, unsigned cube);

  /// The child of a cube of `level` that a tile lies in.
  static unsigned child_of(const Tile& tile, int level) {
    const Eigen::Vector3i& corner = tile.bits->corner;
    const auto upper = [&](int axis) {
      return static_cast<unsigned>((corner[axis] + 32768) >> (level - 1)) & 1U;
    };
    return upper(0) | upper(1) << 1U | upper(2) << 2U;
  }

  /// True when a stored leaf is clamped so that these updates do nothing (OctoMap's early abort).
  bool is_settled(const FusedNode& leaf, bool some_free, bool some_hit) const {
    return (!some_free || leaf.getLogOdds() <= rule_.low) && (!some_hit || leaf.getLogOdds() >= rule_.high);
  }

  /// True when the voxels first..last of a free cube, which one leaf stands for, all get the same update.
  bool is_one_update(const FusedNode& leaf, const Tile& tile, unsigned first, unsigned last) const {
    if (!rule_.distinguishes_clear_looks(before(leaf))) return true;
    const bool clearly = is_clear(tile, first);  // one by one: occupied leaves are seldom larger than a voxel
    while (first < last && is_clear(tile, last) == clearly) --last;
    return first == last;
  }
  static bool is_clear(const Tile& tile, unsigned voxel) {
    return (tile.bits->clear[voxel >> 6U] >> (voxel & 63U) & 1U) != 0;
  }

  static float before(const FusedNode& leaf) { return leaf.observed() ? leaf.getLogOdds() : 0.0F; }
  void hit(FusedNode& leaf) const { leaf.observe(rule_.after_hit(before(leaf))); }
  void miss(FusedNode& leaf, bool clearly) const {
    const float log_odds = before(leaf);
    clearly = clearly && rule_.distinguishes_clear_looks(log_odds);
    leaf.observe(clearly ? rule_.after_clear_look(log_odds) : rule_.after_miss(log_odds));
  }

  std::size_t nodes_ = 0;
  OccupancyUpdate rule_;
};

void FusedTree::ScanUpdate::Tile::read(ScanTile& scan) {
  bits = &scan;
  for (unsigned i = 0; i < ScanTile::words; ++i) {
    scan.free[i] &= ~scan.occupied[i];
    const unsigned group = i >> 6U, bit = i & 63U;
    free[group] |= std::uint64_t{scan.free[i] != 0} << bit;
    hit[group] |= std::uint64_t{scan.occupied[i] != 0} << bit;
    full[group] |= std::uint64_t{scan.free[i] == ~std::uint64_t{0}} << bit;
  }
  for (unsigned group = 0; group < 8; ++group) {
    has_free |= free[group] != 0;
    has_hit |= hit[group] != 0;
  }
}

/// The bits of a cube: those of its voxels, or one for each word in it.
template <int Level>
std::uint64_t FusedTree::ScanUpdate::bits_of(const std::array<std::uint64_t, 8>& of_words,
                                             const std::array<std::uint64_t, 512>& of_voxels, unsigned cube) {
  if constexpr (Level == 4) return of_words[cube];
  if constexpr (Level == 3) return of_words[cube >> 3U] >> 8 * (cube & 7U) & 0xffU;
  if constexpr (Level == 2) return of_voxels[cube];
  if constexpr (Level == 1) return of_voxels[cube >> 3U] >> 8 * (cube & 7U) & 0xffU;
  if constexpr (Level == 0) return of_voxels[cube >> 6U] >> (cube & 63U) & 1U;
  std::uint64_t all = 0;
  if constexpr (Level == 5)
    for (const std::uint64_t word : of_words) all |= word;
  return all;
}

template <int Level>
bool FusedTree::ScanUpdate::all_free(const Tile& tile, unsigned cube) {
  if constexpr (Level == 5)
    return std::all_of(tile.full.begin(), tile.full.end(), [](std::uint64_t word) { return ~word == 0; });
  constexpr std::uint64_t all[] = {1, 0xff, ~std::uint64_t{0}, 0xff, ~std::uint64_t{0}, 0};
  return bits_of<Level>(tile.full, tile.bits->free, cube) == all[Level];
}

template <int Level>
bool FusedTree::ScanUpdate::update_cube(FusedNode& node, bool created, const Tile& tile, unsigned cube) {
  if constexpr (Level == 0) {
    if (any_hit<0>(tile, cube)) {
      hit(node);
    } else {
      miss(node, is_clear(tile, cube));
    }
    return true;
  } else {
    const unsigned first = cube << 3 * Level, last = ((cube + 1) << 3 * Level) - 1;  // voxels
    if (!node.has_children() && all_free<Level>(tile, cube) && is_one_update(node, tile, first, last)) {
      miss(node, is_clear(tile, first));
      return true;
    }
    if constexpr (Level == 2 || Level == 3) node.prefetch_below();
    bool changed = false;
    for (unsigned i = 0; i < 8; ++i) {
      const unsigned below = cube * 8 + i;
      const bool some_free = any_free<Level - 1>(tile, below), some_hit = any_hit<Level - 1>(tile, below);
      if (!some_free && !some_hit) continue;
      if (node.has_children() && node.child(i) != nullptr && !node.child(i)->has_children() &&
          is_settled(*node.child(i), some_free, some_hit))
        continue;
      bool child_created = false;
      FusedNode& child = node.child_for_writing(i, created, child_created, nodes_);
      changed |= update_cube<Level - 1>(child, child_created, tile, below);
    }
    if (changed && !node.prune(nodes_)) node.updateOccupancyChildren();
    return changed;
  }
}

void FusedTree::ScanUpdate::reach_tiles(FusedNode& node, int level, bool created, Tile* first, Tile* last) {
  if (!created && !node.has_children()) {
    const bool some_free = std::any_of(first, last, [](const Tile& tile) { return tile.has_free; });
    const bool some_hit = std::any_of(first, last, [](const Tile& tile) { return tile.has_hit; });
    if (is_settled(node, some_free, some_hit)) return;
  }
  if (level == tile_level) {
    first->node = &node;
    first->created = created;
    return;
  }
  while (first != last) {
    const unsigned index = child_of(*first, level);
    Tile* const next =
        std::find_if(first, last, [&](const Tile& tile) { return child_of(tile, level) != index; });
    bool child_created = false;
    FusedNode& child = node.child_for_writing(index, created, child_created, nodes_);
    reach_tiles(child, level - 1, child_created, first, next);
    first = next;
  }
}

bool FusedTree::ScanUpdate::close_above_tiles(FusedNode& node, int level, const Tile* first,
                                              const Tile* last) {
  if (level == tile_level) return first->changed;
  bool changed = false;
  while (first != last) {
    const unsigned index = child_of(*first, level);
    const Tile* const next =
        std::find_if(first, last, [&](const Tile& tile) { return child_of(tile, level) != index; });
    if (node.has_children())  // else it is settled, and reach_tiles went no further
      changed |= close_above_tiles(*node.child(index), level - 1, first, next);
    first = next;
  }
  if (changed && !node.prune(nodes_)) node.updateOccupancyChildren();
  return changed;
}

void FusedTree::update(ScanGrid& grid, Integration integration, int threads) {
  const std::vector<ScanTile*> scan = grid.tiles();
  std::vector<ScanUpdate::Tile> tiles(scan.size());
  const auto workers = static_cast<std::size_t>(threads);
  parallel(workers, [&](std::size_t worker) {
    for (std::size_t i = worker; i < scan.size(); i += workers) tiles[i].read(*scan[i]);
  });
  std::erase_if(tiles, [](const ScanUpdate::Tile& tile) { return !tile.has_free && !tile.has_hit; });
  if (tiles.empty()) return;
  integration_ = of_both(integration_, map_integration(integration));
  bool created = false;
  FusedNode& top = root_for_writing(created);
  ScanUpdate above(*this, integration);
  ScanUpdate::Tile* const first = tiles.data();
  above.reach_tiles(top, static_cast<int>(tree_depth), created, first, first + tiles.size());

  std::atomic<std::size_t> next{0}, grown{0};
  parallel(workers, [&](std::size_t) {
    ScanUpdate update(*this, integration);
    for (std::size_t i = next++; i < tiles.size(); i = next++) {
      ScanUpdate::Tile& tile = tiles[i];
      if (tile.node != nullptr)
        tile.changed = update.update_cube<ScanUpdate::tile_level>(*tile.node, tile.created, tile, 0);
    }
    grown += update.nodes();
  });
  above.close_above_tiles(top, static_cast<int>(tree_depth), first, first + tiles.size());
  tree_size += grown + above.nodes();
  size_changed = true;
}

}  // namespace clearway
