// What a later version of a block keeps of the tiles of an earlier one.

#include <algorithm>
#include <utility>

#include "mapping/field/distance_tiles.hpp"

namespace clearway {
namespace {

/// The least squared distance, in half voxels, from cells of one box to cells of the other.
int least_between(const CellBox& a, const CellBox& b) {
  const Eigen::Array3i steps = (b.low - a.high).cwiseMax(a.low - b.high).array() + 1;
  int sum = 0;
  for (const int along : steps) sum += gap_squared(std::max(along, 0));
  return sum;
}

}  // namespace

/// Keeps the tiles that no change reaches.
void DistanceTiles::share(const DistanceTiles& before, const std::vector<Box>& changes) {
  std::vector<bool> is_outdated = reached_by_changes(changes);
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    if (tiles_[i] == nullptr) {
      is_outdated[i] = false;
    } else if (is_outdated[i]) {
      tiles_[i] = nullptr;
    } else {
      known_[i] = tiles_[i]->data();
    }
  }
  for (const std::size_t i : before.outdated_) is_outdated[i] = tiles_[i] == nullptr;
  for (std::size_t i = 0; i < tiles_.size(); ++i)
    if (is_outdated[i]) outdated_.push_back(i);
}

/// Whether a number of a known tile is at least so much.
bool DistanceTiles::any_at_least(std::size_t tile, int distance) const {
  const Tile& cells = *tiles_[tile];
  for (std::size_t cell = 0; cell < tile_cells; cell += nx)
    if (axes_.any_at_least(&cells[cell], static_cast<std::uint16_t>(distance))) return true;
  return false;
}

/// The known tiles whose distances a changed cell can have changed: where a distance is at least that to the
/// change. Smaller ones end at another cell, before and after.
std::vector<bool> DistanceTiles::reached_by_changes(const std::vector<Box>& changes) const {
  std::vector<bool> reached(tiles_.size(), false);
  std::vector<int> at_most(tiles_.size(), cap() - 1);  // what is known of each tile: the cap is no distance
  for (const auto& [changed, cells] : changes_in_tiles(changes)) {
    if (!is_read_[changed]) continue;
    const Eigen::Vector3i low = (place(changed) - reach_).cwiseMax(0);
    const Eigen::Vector3i high = (place(changed) + reach_).cwiseMin(counts_ - Eigen::Vector3i::Ones());
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          const std::size_t i = tile(x, y * ny, z * nz);
          if (tiles_[i] == nullptr || reached[i]) continue;
          const int between = least_between(box_of({x, y, z}), cells);
          if (between > at_most[i]) continue;
          reached[i] = any_at_least(i, between);
          at_most[i] = between - 1;  // where it is not reached
        }
      }
    }
  }
  return reached;
}

/// The tiles that hold cells of the boxes, and of each a box about these cells.
std::vector<std::pair<std::size_t, DistanceTiles::Box>> DistanceTiles::changes_in_tiles(
    const std::vector<Box>& changes) const {
  constexpr int none = -1;
  std::vector<std::pair<std::size_t, Box>> in_tiles;
  std::vector<int> number(tiles_.size(), none);  // of each tile in `in_tiles`
  for (const Box& change : changes) {
    for (int z = change.low.z() / nz; z * nz < change.high.z(); ++z) {
      for (int y = change.low.y() / ny; y * ny < change.high.y(); ++y) {
        for (int x = change.low.x() / nx; x * nx < change.high.x(); ++x) {
          const std::size_t i = tile(x, y * ny, z * nz);
          const Box here = box_of({x, y, z});
          if (number[i] == none) {
            number[i] = static_cast<int>(in_tiles.size());
            in_tiles.emplace_back(i, Box{here.high, here.low});
          }
          Box& cells = in_tiles[static_cast<std::size_t>(number[i])].second;
          cells.low = cells.low.cwiseMin(change.low.cwiseMax(here.low));
          cells.high = cells.high.cwiseMax(change.high.cwiseMin(here.high));
        }
      }
    }
  }
  return in_tiles;
}

}  // namespace clearway
