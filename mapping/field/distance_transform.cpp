#include "mapping/field/distance_transform.hpp"

#include <algorithm>

#include "mapping/field/distance_tiles.hpp"

namespace clearway {

DistanceBlock::DistanceBlock(int x, int y, int z, std::uint16_t truncation)
    : nx(x), ny(y), nz(z), stride((x + lane - 1) / lane * lane), cap(truncation) {
  squared.assign(
      static_cast<std::size_t>(stride) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), cap);
}

void transform_distances(DistanceBlock& block) {
  BlockedCells blocked({block.nx, block.ny, block.nz}, false);
  for (int z = 0; z < block.nz; ++z) {
    for (int y = 0; y < block.ny; ++y) {
      const std::uint16_t* row = &block.squared[block.index(0, y, z)];
      for (int x = 0; x < block.nx; ++x) {
        if (row[x] == 0) blocked.fill({x, y, z}, {x + 1, y + 1, z + 1}, true);
      }
    }
  }
  const DistanceTiles tiles(std::move(blocked), block.cap);
  for (int z = 0; z < block.nz; ++z) {
    for (int y = 0; y < block.ny; ++y) {
      for (int x = 0; x < block.nx; x += DistanceBlock::lane) {
        const int count = std::min(DistanceBlock::lane, block.nx - x);
        std::copy_n(tiles.line(x / DistanceBlock::lane, y, z), count, &block.squared[block.index(x, y, z)]);
      }
    }
  }
}

}  // namespace clearway
