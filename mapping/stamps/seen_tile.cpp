#include "mapping/stamps/seen_tile.hpp"

#include <algorithm>
#include <bit>

#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

SeenTile::SeenTile(const SeenTile& other)
    : owner(other.owner), corner_(other.corner_), uniform_(other.uniform_) {
  for (std::size_t block = 0; block < blocks; ++block) {
    if (other.mixed_[block]) mixed_[block] = std::make_unique<Block>(*other.mixed_[block]);
  }
}

void SeenTile::set_uniform(std::size_t block, std::uint16_t stamp) {
  mixed_[block].reset();
  uniform_[block] = stamp;
}

SeenTile::Block& SeenTile::spread(std::size_t block) {
  if (!mixed_[block]) {
    mixed_[block] = std::make_unique<Block>();
    mixed_[block]->fill(uniform_[block]);
  }
  return *mixed_[block];
}

void SeenTile::raise(const ScanTile& scan, std::uint16_t stamp) {
  constexpr std::size_t words = block_cells / 64;
  for (std::size_t block = 0; block < blocks; ++block) {
    std::array<std::uint64_t, words> seen{};
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (std::size_t i = 0; i < words; ++i) {
      seen[i] = scan.free[block * words + i] | scan.occupied[block * words + i];
      any |= seen[i];
      all &= seen[i];
    }
    if (any == 0 || (!mixed_[block] && uniform_[block] >= stamp)) continue;
    const bool is_whole = ~all == 0 && (!mixed_[block] || *std::max_element(mixed_[block]->begin(),
                                                                            mixed_[block]->end()) <= stamp);
    if (is_whole) {
      set_uniform(block, stamp);
      continue;
    }
    std::uint16_t* cells = spread(block).data();
    for (std::size_t i = 0; i < words; ++i, cells += 64) {
      if (~seen[i] == 0) {
        for (std::size_t at = 0; at < 64; ++at) cells[at] = std::max(cells[at], stamp);
        continue;
      }
      for (std::uint64_t left = seen[i]; left != 0; left &= left - 1) {
        std::uint16_t& cell = cells[std::countr_zero(left)];
        cell = std::max(cell, stamp);
      }
    }
  }
}

void SeenTile::raise(const SeenTile& other) {
  for (std::size_t block = 0; block < blocks; ++block) {
    if (!mixed_[block] && !other.mixed_[block]) {
      uniform_[block] = std::max(uniform_[block], other.uniform_[block]);
      continue;
    }
    Block& cells = spread(block);
    for (unsigned i = 0; i < block_cells; ++i)
      cells[i] = std::max(cells[i], other.at(static_cast<unsigned>(block) << 9U | i));
  }
}

std::size_t SeenTile::bytes() const {
  std::size_t bytes = sizeof(SeenTile);
  for (const auto& block : mixed_) bytes += block ? sizeof(Block) : 0;
  return bytes;
}

}  // namespace clearway
