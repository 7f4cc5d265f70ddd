#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace clearway {

class BlockedField;

/// A BlockedField again with one byte a cell in one piece of memory, x fastest, for look-ups of many points
/// side by side: half the memory, no tiles, and a third of a voxel less exact.
/// Immutable: safe to read from many threads.
struct ByteField {
  explicit ByteField(const BlockedField& field);

  Eigen::Vector3i size;             ///< cells along each axis
  Eigen::Vector3d low;              ///< corner of the first cell, map frame, metres
  double resolution;                ///< edge of a cell, metres
  double step;                      ///< metres for each unit of a cell's number
  bool outside_blocked;             ///< what lies beyond the cells counts as blocked
  std::vector<std::uint8_t> cells;  ///< and a few more, so that four bytes may be read at each
  /// Of a cell: step * number <= the distance from its middle to the nearest blocked cube, metres, which is
  /// less than step * (number + 1) where the number is below this. 0 in blocked cells only.
  std::uint8_t end;
};

}  // namespace clearway
