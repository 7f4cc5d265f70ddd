#include "mapping/scans/safe_scan.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "mapping/system/parallel.hpp"

namespace clearway {
namespace {

constexpr int widest = 4;             // steps: a block ends a word, 4 cells, beyond its tile
constexpr int tile_words = 8;         // of 4 x 4 x 4 cells along an edge of a tile
constexpr int edge = tile_words + 2;  // of a block: a tile and one word of its neighbours around it
constexpr int block_size = edge * edge * edge;
constexpr std::array<int, 3> stride{1, edge, edge* edge};
/// Empty words before the first and after the last, so that each word has one before and behind it.
constexpr int pad = edge * edge;
using Block = std::array<std::uint64_t, block_size + 2 * pad>;

/// Of a growth: edges and faces in turn, so that it stays round.
GrowthStep step_number(int i) { return i % 2 == 0 ? GrowthStep::edges : GrowthStep::faces; }

/// Where a block's word comes from: which of the 27 tiles (middle: 13), and which word of it.
struct Origin {
  std::uint8_t tile;
  std::uint16_t word;
};

constexpr std::array<Origin, block_size> origins = [] {
  std::array<Origin, block_size> table{};
  for (int z = 0; z < edge; ++z) {
    for (int y = 0; y < edge; ++y) {
      for (int x = 0; x < edge; ++x) {
        const std::array<int, 3> at{x, y, z};
        unsigned word = 0;
        int tile = 0, weight = 1;
        for (unsigned axis = 0; axis < 3; ++axis, weight *= 3) {
          tile += weight * ((at[axis] + tile_words - 1) / tile_words);
          const auto local = static_cast<unsigned>(at[axis] + tile_words - 1) % tile_words;
          for (unsigned bit = 0; bit < 3; ++bit) word |= (local >> bit & 1U) << (3 * bit + axis);
        }
        table[static_cast<std::size_t>(x + edge * (y + edge * z))] = {static_cast<std::uint8_t>(tile),
                                                                      static_cast<std::uint16_t>(word)};
      }
    }
  }
  return table;
}();

/// Bits of a word whose cells have this coordinate (0 to 3) along the axis.
constexpr std::uint64_t slice(unsigned axis, unsigned coordinate) {
  std::uint64_t mask = 0;
  for (unsigned bit = 0; bit < 64; ++bit) {
    const unsigned at = (bit >> axis & 1U) | (bit >> (axis + 3) & 1U) << 1U;
    if (at == coordinate) mask |= std::uint64_t{1} << bit;
  }
  return mask;
}

/// `from` and all cells one before and one behind along the axis. In octree order a step from an even
/// coordinate moves a bit by s = 2^axis, one from 1 to 2 by 7 s, one into the next word by -9 s.
template <unsigned Axis>
void widen(const Block& from, Block& to) {
  constexpr unsigned s = 1U << Axis;
  constexpr std::uint64_t c0 = slice(Axis, 0), c1 = slice(Axis, 1), c2 = slice(Axis, 2), c3 = slice(Axis, 3);
  constexpr int next = stride[Axis];
  for (int i = pad; i < pad + block_size; ++i) {
    const std::uint64_t w = from[static_cast<std::size_t>(i)];
    const std::uint64_t before = from[static_cast<std::size_t>(i - next)];
    const std::uint64_t behind = from[static_cast<std::size_t>(i + next)];
    to[static_cast<std::size_t>(i)] = w | (w & (c0 | c2)) << s | (w & c1) << 7 * s | (before & c3) >> 9 * s |
                                      (w & (c1 | c3)) >> s | (w & c2) >> 7 * s | (behind & c0) << 9 * s;
  }
}

void add(const Block& from, Block& to) {
  for (std::size_t i = 0; i < from.size(); ++i) to[i] |= from[i];
}

/// Work memory of one thread. Words on the rim of a block are wrong after growing, by at most the 4 cells
/// that a word has; the tile in its middle is right.
struct Grower {
  Block cells{}, x{}, y{}, z{};

  void grow(GrowthStep step) {
    widen<0>(cells, x);
    if (step == GrowthStep::faces) {
      widen<1>(cells, y);
      widen<2>(cells, z);
      add(x, z);
      add(y, z);
    } else {
      widen<1>(x, y);
      widen<2>(x, z);
      add(y, z);
      widen<1>(cells, x);
      widen<2>(x, y);
      add(y, z);
    }
    std::swap(cells, z);
  }

  /// The occupied cells of a tile and around it. False when there are none.
  bool gather(const ScanGrid& grid, const ScanTile& tile) {
    std::array<const ScanTile*, 27> around{};
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i corner =
          tile.corner + ScanTile::edge * Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const bool stored = (corner.array() >= -32768).all() && (corner.array() <= 32767).all();
      around[static_cast<std::size_t>(i)] = stored ? grid.find(corner) : nullptr;
    }
    std::uint64_t any = 0;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      const ScanTile* source = around[origins[i].tile];
      const std::uint64_t word = source == nullptr ? 0 : source->occupied[origins[i].word];
      cells[pad + i] = word;
      any |= word;
    }
    return any != 0;
  }

  void put_into(std::array<std::uint64_t, ScanTile::words>& bits) const {
    constexpr std::uint8_t middle = 13;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (origins[i].tile == middle) bits[origins[i].word] = cells[pad + i];
    }
  }

  void take_out(std::array<std::uint64_t, ScanTile::words>& bits) const {
    constexpr std::uint8_t middle = 13;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (origins[i].tile == middle) bits[origins[i].word] &= ~cells[pad + i];
    }
  }
};

void spare(const ScanGrid& grid, const SurfaceMargins& margins, ScanTile& tile, Grower& grower) {
  tile.clear = tile.free;
  if (margins.notes_spared) tile.spared.fill(0);
  const auto is_zero = [](std::uint64_t word) { return word == 0; };
  const bool frees = !std::all_of(tile.free.begin(), tile.free.end(), is_zero);
  if ((!frees && !margins.notes_spared) || !grower.gather(grid, tile)) return;
  for (const GrowthStep step : margins.spared) grower.grow(step);
  if (margins.notes_spared) grower.put_into(tile.spared);
  if (!frees) return;
  if (!margins.spared.empty()) grower.take_out(tile.free);
  for (const GrowthStep step : margins.unclear) grower.grow(step);
  grower.take_out(tile.clear);
}

void spare_around(const ScanGrid& ends, const SurfaceMargins& margins, ScanTile& tile, Grower& grower) {
  if (!grower.gather(ends, tile)) return;
  for (const GrowthStep step : margins.spared) grower.grow(step);
  grower.take_out(tile.free);
  for (const GrowthStep step : margins.unclear) grower.grow(step);
  grower.take_out(tile.clear);
}

/// Visits each tile of a grid with the work memory of a thread.
template <typename Visit>
void visit_tiles(ScanGrid& grid, int threads, const Visit& visit) {
  const std::vector<ScanTile*> tiles = grid.tiles();
  std::atomic<std::size_t> next{0};
  parallel(static_cast<std::size_t>(threads), [&](std::size_t) {
    Grower grower;
    for (std::size_t i = next++; i < tiles.size(); i = next++) visit(*tiles[i], grower);
  });
}

}  // namespace

std::vector<GrowthStep> growth_of(double band, double resolution) {
  if (!(band > 0.0)) return {};
  const int radius = static_cast<int>(std::min<double>(widest, std::round(band / resolution)));
  if (radius == 0) return {GrowthStep::faces};
  std::vector<GrowthStep> steps;
  for (int i = 0; i < radius; ++i) steps.push_back(step_number(i));
  return steps;
}

std::vector<GrowthStep> clear_growth_of(double band, double resolution) {
  const auto done = static_cast<int>(growth_of(band, resolution).size());
  std::vector<GrowthStep> steps;
  for (int i = done; i < std::min(widest, 2 * done); ++i) steps.push_back(step_number(i));
  return steps;
}

void spare_surfaces(ScanGrid& grid, const SurfaceMargins& margins, int threads) {
  visit_tiles(grid, threads, [&](ScanTile& tile, Grower& grower) { spare(grid, margins, tile, grower); });
}

void spare_around(const ScanGrid& ends, const SurfaceMargins& margins, ScanGrid& grid, int threads) {
  if (ends.tile_count() == 0) return;
  visit_tiles(grid, threads,
              [&](ScanTile& tile, Grower& grower) { spare_around(ends, margins, tile, grower); });
}

}  // namespace clearway
