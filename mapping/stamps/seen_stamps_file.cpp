// Stamps as bytes: after a head tile by tile, and in a tile block by block. A block of one stamp is that
// stamp; any other is a palette of its stamps and for each cell a number in it, in as few bits as all need.
// So reading takes a bounded multiple of the file's size, whatever the file says.

#include <algorithm>
#include <bit>
#include <cmath>

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/byte_reader.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t every_key = std::uint64_t{1} << 33U;
constexpr int coarsest_exponent = 32;  ///< more than 2 latest_time / 65534 periods need

/// The different stamps of a block, ascending.
std::vector<std::uint16_t> palette_of(const SeenTile& tile, std::size_t block) {
  if (tile.mixed(block) == nullptr) return {tile.uniform(block)};
  std::vector<std::uint16_t> stamps(tile.mixed(block)->begin(), tile.mixed(block)->end());
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  return stamps;
}

/// Bits of a number in a palette.
unsigned width_of(std::size_t palette) { return static_cast<unsigned>(std::bit_width(palette - 1)); }

void put_block(std::string& bytes, const SeenTile::Block& cells, const std::vector<std::uint16_t>& palette) {
  put(bytes, static_cast<std::uint16_t>(palette.size()));
  for (const std::uint16_t stamp : palette) put(bytes, stamp);
  const unsigned width = width_of(palette.size());
  std::uint64_t bits = 0;
  unsigned filled = 0;
  for (const std::uint16_t stamp : cells) {  // 512 numbers end with a byte, whatever their width
    const auto number = std::lower_bound(palette.begin(), palette.end(), stamp) - palette.begin();
    bits |= static_cast<std::uint64_t>(number) << filled;
    for (filled += width; filled >= 8; filled -= 8, bits >>= 8U) put(bytes, static_cast<std::uint8_t>(bits));
  }
}

void put_tile(std::string& bytes, std::uint64_t key, const SeenTile& tile) {
  std::uint64_t mixed = 0;
  std::array<std::vector<std::uint16_t>, SeenTile::blocks> palettes;
  bool any = false;
  for (std::size_t block = 0; block < SeenTile::blocks; ++block) {
    palettes[block] = palette_of(tile, block);
    if (palettes[block].size() > 1) mixed |= std::uint64_t{1} << block;
    any |= palettes[block].back() != 0;
  }
  if (!any) return;
  put(bytes, key);
  put(bytes, mixed);
  for (std::size_t block = 0; block < SeenTile::blocks; ++block) {
    if (palettes[block].size() > 1) {
      put_block(bytes, *tile.mixed(block), palettes[block]);
    } else {
      put(bytes, palettes[block].front());
    }
  }
}

void read_block(ByteReader& reader, std::uint16_t newest, SeenTile::Block& cells) {
  const auto size = reader.get<std::uint16_t>();
  if (size < 2 || size > SeenTile::block_cells) reader.refuse("a block of look times has no palette");
  std::vector<std::uint16_t> palette;
  for (std::size_t i = 0; i < size; ++i) {
    palette.push_back(reader.get<std::uint16_t>());
    const bool is_ordered = i == 0 || palette[i - 1] < palette[i];
    if (!is_ordered || palette[i] > newest) reader.refuse("a voxel was seen later than the newest look");
  }
  const unsigned width = width_of(size);
  const std::string_view packed = reader.take(width * SeenTile::block_cells / 8);
  for (std::size_t i = 0; i < SeenTile::block_cells; ++i) {
    std::size_t number = 0;
    for (std::size_t bit = 0; bit < width; ++bit) {
      const std::size_t at = i * width + bit;
      number |= std::size_t{static_cast<unsigned char>(packed[at / 8]) >> at % 8 & 1U} << bit;
    }
    if (number >= size) reader.refuse("a look time is not in its palette");
    cells[i] = palette[number];
  }
}

void read_tile(ByteReader& reader, std::uint16_t newest, SeenTile& tile) {
  const auto mixed = reader.get<std::uint64_t>();
  for (std::size_t block = 0; block < SeenTile::blocks; ++block) {
    if ((mixed >> block & 1U) != 0) {
      read_block(reader, newest, tile.spread(block));
      continue;
    }
    const auto stamp = reader.get<std::uint16_t>();
    if (stamp > newest) reader.refuse("a voxel was seen later than the newest look");
    tile.set_uniform(block, stamp);
  }
}

}  // namespace

std::string format_seen(const SeenStamps& seen) {
  std::string bytes;
  put(bytes, static_cast<std::int32_t>(seen.exponent_));
  put(bytes, seen.base_);
  put(bytes, seen.newest());
  for (const SeenStamps::Entry& each : *seen.table_) {
    if (each.tile) put_tile(bytes, each.key, *each.tile);
  }
  return bytes;
}

SeenStamps parse_seen(std::string_view bytes, const std::filesystem::path& file) {
  ByteReader reader(bytes, file);
  SeenStamps seen;
  seen.exponent_ = reader.get<std::int32_t>();
  if (seen.exponent_ < SeenStamps::finest_exponent || seen.exponent_ > coarsest_exponent)
    reader.refuse("its look times have no period");
  seen.base_ = reader.get<std::int64_t>();
  const auto newest = reader.get<double>();
  const bool is_time = std::abs(newest) <= SeenStamps::latest_time;
  const std::int64_t last = is_time ? seen.index_of(newest) : 0;
  if (!is_time || seen.base_ > last || seen.base_ <= last - SeenStamps::most_periods)
    reader.refuse("its newest look has no time");
  seen.newest_ = newest;
  SeenStamps::Table& table = seen.table_for_writing();
  while (!reader.at_end()) {
    const auto key = reader.get<std::uint64_t>();
    if (key >= every_key || (!table.empty() && key <= table.back().key))
      reader.refuse("its tiles of look times are not in order");
    table.push_back({key, nullptr});
    read_tile(reader, static_cast<std::uint16_t>(last - seen.base_ + 1),
              seen.tile_for_writing(table.back(), SeenStamps::corner_of(key)));
  }
  return seen;
}

}  // namespace clearway
