#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

class FusedTree;
class ScanGrid;
struct CellCube;

/// One voxel that became a conflict, and what came second.
struct ConflictRecord {
  Eigen::Vector3i cell = Eigen::Vector3i::Zero();  ///< of the voxel, see FusedTree::cell
  double time = 0.0;                               ///< seconds: of the scan or sphere that came second
  bool by_scan = false;                            ///< a scan hit painted space; else paint met an obstacle
  int index = -1;   ///< of the scan (in order of insertion), or of the stroke (-1: outside any stroke)
  int volume = -1;  ///< that was painted second; -1 for a scan
};

/// Conflicts as they appeared: at most `record_limit` are kept with their circumstances, the others counted.
struct ConflictLog {
  static constexpr std::size_t record_limit = 10000;
  std::vector<ConflictRecord> records;
  std::size_t not_kept = 0;
};

/// Notices voxels that become conflicts while a map is painted and scans arrive. A voxel that stops being one
/// and becomes one again is recorded again. Watches at most `watch_limit` voxels that are conflicts at the
/// same time; what comes beyond is counted as not kept, each time it is met.
class ConflictWatch {
 public:
  static constexpr std::size_t watch_limit = 100000;

  /// After a sphere was painted; `newly` are cubes of occupied voxels that the volume had not painted before.
  void painted(const Sphere& sphere, double resolution, const std::vector<CellCube>& newly, double time,
               int stroke, int volume);
  /// After a scan was inserted; `grid` holds what it touched.
  void inserted(const FusedTree& tree, ScanGrid& grid, double time, int scan);
  /// After paint was taken off or put back.
  void repainted(const FusedTree& tree);

  /// A volume is no more: nothing is said of what was painted into it.
  void forget(int volume);

  const ConflictLog& log() const { return log_; }

 private:
  using Cell = std::array<int, 3>;
  void meet(const ConflictRecord& record);
  bool watches(const Eigen::Vector3i& tile_corner) const;

  ConflictLog log_;
  std::set<Cell> present_;           ///< voxels that are conflicts now
  std::set<Cell> painted_tiles_;     ///< corners of the scan tiles that hold paint
  bool painted_everywhere_ = false;  ///< some sphere was too large to list its tiles
};

}  // namespace clearway
