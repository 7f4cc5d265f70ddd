// Stamps made of stamps, as maps are made of maps.

#include <algorithm>

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

SeenStamps SeenStamps::later(const SeenStamps& a, const SeenStamps& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  // Both in the same periods, with numbers that span the looks of both.
  const int exponent = std::max(a.exponent_, b.exponent_);
  const auto base_of = [&](const SeenStamps& seen) { return seen.base_ >> (exponent - seen.exponent_); };
  if (base_of(b) < base_of(a)) return later(b, a);  // the order of the maps is not seen in the bytes
  SeenStamps result(a), other(b);
  for (SeenStamps* each : {&result, &other}) each->rebase(exponent - each->exponent_, base_of(*each));
  result.make_room(other.base_);
  result.make_room(result.index_of(other.newest()));
  other.rebase(result.exponent_ - other.exponent_, result.base_);

  std::vector<std::uint64_t> keys;
  for (const Entry& each : *other.table_) keys.push_back(each.key);
  result.add_entries(std::move(keys));
  for (const Entry& each : *other.table_) {
    if (!each.tile) continue;
    Entry& entry = result.entry(each.key);
    if (entry.tile) {
      result.tile_for_writing(entry, each.tile->corner()).raise(*each.tile);
    } else {
      entry.tile = each.tile;
    }
  }
  result.newest_ = std::max(a.newest(), b.newest());
  return result;
}

SeenStamps SeenStamps::cropped(const Eigen::Vector3i& first, const Eigen::Vector3i& last) const {
  SeenStamps result(*this);
  Table kept;
  for (Entry& each : result.table_for_writing()) {
    if (!each.tile) continue;
    const Eigen::Array3i low = each.tile->corner().array(), high = low + (SeenTile::edge - 1);
    if ((low > last.array()).any() || (high < first.array()).any()) continue;
    const bool is_inside = (low >= first.array()).all() && (high <= last.array()).all();
    if (!is_inside) {
      SeenTile& tile = result.tile_for_writing(each, each.tile->corner());
      for (unsigned bit = 0; bit < SeenTile::blocks * SeenTile::block_cells; ++bit) {
        const Eigen::Array3i cell = (tile.corner() + ScanTile::local_of(bit)).array();
        const bool is_kept = (cell >= first.array()).all() && (cell <= last.array()).all();
        if (!is_kept && tile.at(bit) != 0) tile.spread(bit >> 9U)[bit & 511U] = 0;
      }
    }
    kept.push_back(each);
  }
  *result.table_ = std::move(kept);
  return result;
}

namespace {

/// The eight blocks of `from` that become the block `to` of a tile of twice the edge: one cell for each eight
/// in a row, in octree order.
void halve(const SeenTile& from, std::size_t first, SeenTile& result, std::size_t to) {
  SeenTile::Block& cells = result.spread(to);
  for (unsigned cell = 0; cell < SeenTile::block_cells; ++cell) {
    std::uint16_t least = 65535;
    for (unsigned i = 0; i < 8; ++i)
      least = std::min(least, from.at(static_cast<unsigned>(first << 9U) + 8 * cell + i));
    cells[cell] = least;
  }
  if (std::all_of(cells.begin(), cells.end(), [&](std::uint16_t stamp) { return stamp == cells.front(); }))
    result.set_uniform(to, cells.front());
}

}  // namespace

SeenStamps SeenStamps::halved() const {
  SeenStamps result(*this);
  const auto half = [](const SeenTile& tile) {
    return Eigen::Vector3i(tile.corner() / 2);  // a multiple of 16: exact
  };
  std::vector<std::uint64_t> keys;
  for (const Entry& each : *table_) {
    if (each.tile) keys.push_back(key_of(half(*each.tile)));
  }
  result.table_for_writing().clear();
  result.add_entries(std::move(keys));
  for (const Entry& each : *table_) {
    if (!each.tile) continue;
    const Eigen::Vector3i cell = half(*each.tile);
    SeenTile& tile = result.tile_for_writing(result.entry(key_of(cell)), corner_of(key_of(cell)));
    const std::size_t octant = ScanTile::bit_of(cell) >> 12U;
    for (std::size_t i = 0; i < 8; ++i) halve(*each.tile, 8 * i, tile, 8 * octant + i);
  }
  return result;
}

}  // namespace clearway
