#include "mapping/field/tiled_cells.hpp"

#include <algorithm>
#include <cstring>

#include "mapping/field/tile_pool.hpp"

namespace clearway {

TiledCells::TiledCells(const Eigen::Vector3i& size, std::uint16_t value)
    : size_((size.x() + nx - 1) / nx, (size.y() + ny - 1) / ny, (size.z() + nz - 1) / nz) {
  const auto uniform = std::allocate_shared<Tile>(TileAllocator<Tile>());
  uniform->fill(value);
  tiles_.assign(size_.cast<std::size_t>().prod(), uniform);
  cells_.assign(tiles_.size(), uniform->data());
  shared_.assign(tiles_.size(), 1);
}

bool TiledCells::write(int lane, int y, int z, const std::uint16_t* line) {
  const std::size_t index = tile(lane, y, z);
  constexpr std::size_t bytes = nx * sizeof(std::uint16_t);
  std::uint16_t* cells = cells_[index] + offset(y, z);
  if (std::memcmp(cells, line, bytes) == 0) return false;
  if (shared_[index] != 0) {
    tiles_[index] = std::allocate_shared<Tile>(TileAllocator<Tile>(), *tiles_[index]);
    shared_[index] = 0;
    cells_[index] = tiles_[index]->data();
    cells = cells_[index] + offset(y, z);
  }
  std::memcpy(cells, line, bytes);
  return true;
}

std::size_t TiledCells::distinct_tiles() const {
  std::vector<const Tile*> kept;
  kept.reserve(tiles_.size());
  for (const auto& tile : tiles_) kept.push_back(tile.get());
  std::sort(kept.begin(), kept.end());
  return static_cast<std::size_t>(std::unique(kept.begin(), kept.end()) - kept.begin());
}

}  // namespace clearway
