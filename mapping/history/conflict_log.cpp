#include "mapping/history/conflict_log.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {
namespace {

using Cell = std::array<int, 3>;

Cell key(const Eigen::Vector3i& cell) { return {cell.x(), cell.y(), cell.z()}; }

bool is_conflict(const FusedTree& tree, const Eigen::Vector3i& cell) {
  CellCube cube;
  const FusedNode* leaf = tree.find_leaf(cell, cube);
  return leaf != nullptr && tree.state(*leaf) == VoxelState::conflict;
}

/// Calls `visit` for each occupied cell of a tile.
template <class Visit>
void visit_occupied(const ScanTile& tile, const Visit& visit) {
  for (unsigned word = 0; word < ScanTile::words; ++word) {
    for (std::uint64_t bits = tile.occupied[word]; bits != 0; bits &= bits - 1)
      visit(tile.cell_of(word * 64 + static_cast<unsigned>(std::countr_zero(bits))));
  }
}

}  // namespace

void ConflictWatch::meet(const ConflictRecord& record) {
  if (present_.contains(key(record.cell))) return;
  if (present_.size() < watch_limit) {
    present_.insert(key(record.cell));
    if (log_.records.size() < ConflictLog::record_limit) {
      log_.records.push_back(record);
      return;
    }
  }
  ++log_.not_kept;
}

void ConflictWatch::painted(const Sphere& sphere, double resolution, const std::vector<CellCube>& newly,
                            double time, int stroke, int volume) {
  constexpr double widest = 8.0;  // tiles along an edge that are listed one by one
  const double tile_edge = ScanTile::edge * resolution;
  if (2.0 * sphere.radius > widest * tile_edge) painted_everywhere_ = true;
  if (!painted_everywhere_) {
    const auto tile = [&](const Eigen::Array3d& point) {
      return Eigen::Array3i((point / tile_edge).floor().max(-1024.0).min(1023.0).cast<int>());
    };
    const Eigen::Array3i low = tile(sphere.center.array() - sphere.radius),
                         high = tile(sphere.center.array() + sphere.radius);
    for (int x = low.x(); x <= high.x(); ++x) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int z = low.z(); z <= high.z(); ++z)
          painted_tiles_.insert({x * ScanTile::edge, y * ScanTile::edge, z * ScanTile::edge});
      }
    }
  }
  for (const CellCube& cube : newly) {
    for (std::size_t i = 0; i < cube.volume(); ++i) {
      if (present_.size() >= watch_limit) {
        log_.not_kept += cube.volume() - i;
        break;
      }
      const auto edge = static_cast<std::size_t>(cube.edge);
      const Eigen::Vector3i step(static_cast<int>(i % edge), static_cast<int>(i / edge % edge),
                                 static_cast<int>(i / edge / edge));
      meet({cube.corner + step, time, false, stroke, volume});
    }
  }
}

bool ConflictWatch::watches(const Eigen::Vector3i& tile_corner) const {
  return painted_everywhere_ || painted_tiles_.contains(key(tile_corner));
}

void ConflictWatch::inserted(const FusedTree& tree, ScanGrid& grid, double time, int scan) {
  if (!painted_everywhere_ && painted_tiles_.empty()) return;
  std::erase_if(present_, [&](const Cell& cell) {
    const Eigen::Vector3i at(cell[0], cell[1], cell[2]);
    return grid.is_free(at) && !is_conflict(tree, at);
  });
  for (const ScanTile* tile : grid.tiles()) {
    if (!watches(tile->corner)) continue;
    visit_occupied(*tile, [&](const Eigen::Vector3i& cell) {
      if (is_conflict(tree, cell)) meet({cell, time, true, scan, -1});
    });
  }
}

void ConflictWatch::repainted(const FusedTree& tree) {
  std::erase_if(present_, [&](const Cell& cell) { return !is_conflict(tree, {cell[0], cell[1], cell[2]}); });
}

void ConflictWatch::forget(int volume) {
  std::erase_if(log_.records, [volume](const ConflictRecord& record) { return record.volume == volume; });
}

}  // namespace clearway
