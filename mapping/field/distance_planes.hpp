#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/field/blocked_cells.hpp"
#include "mapping/field/distance_axes.hpp"
#include "mapping/field/tiled_cells.hpp"

namespace clearway {

/// A change of bits, and which lines of distances within the planes it changed. Threads that work on
/// different lanes, or on different rows, may share one.
class DistanceChange {
 public:
  /// @param alike what all cells were before, when they were all alike; then `was` is not read.
  DistanceChange(const BlockedCells& was, std::optional<bool> alike, const BlockedCells& is,
                 std::uint16_t cap)
      : before(was),
        after(is),
        uniform(alike),
        axes(cap),
        lines_(static_cast<std::size_t>(is.lanes()) * static_cast<std::size_t>(is.size().y()) *
               static_cast<std::size_t>(is.size().z())) {}

  /// What changed in each lane of a row along x.
  LineChange* row(int y, int z) {
    return &lines_[(static_cast<std::size_t>(z) * static_cast<std::size_t>(after.size().y()) +
                    static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(after.lanes())];
  }

  const BlockedCells& before;
  const BlockedCells& after;
  const std::optional<bool> uniform;
  const DistanceAxes axes;

 private:
  std::vector<LineChange> lines_;
};

/// Carries a change through the first two axes, one lane at a time: z by counting, then y. Holds what one
/// thread needs for it.
class PlaneUpdate {
 public:
  explicit PlaneUpdate(DistanceChange& change);

  /// Brings the distances within the planes of y and z up to date for the 32 columns of x of a lane, and
  /// notes the lines that changed.
  void lane(TiledCells& planes, int lane);

 private:
  bool find_columns(int lane);
  void count_old_steps(int lane);
  void plane_line(TiledCells& planes, int lane, int z);
  bool find_reach(int z);
  const std::uint8_t* steps(int y, int z) const {
    return &steps_[static_cast<std::size_t>(z * ny_ + y) * lane_cells];
  }
  const std::uint8_t* old_steps(std::size_t column, int z) const {
    if (change_.uniform) return uniform_line_.data();
    return &old_steps_[(static_cast<std::size_t>(z) * columns_.size() + column) * lane_cells];
  }

  DistanceChange& change_;
  const DistanceAxes& axes_;
  int ny_, nz_;
  std::vector<std::uint8_t> uniform_line_;       ///< steps of a line before, when all cells were alike
  std::vector<int> columns_;                     ///< of the lane, y
  std::vector<std::uint8_t> steps_, old_steps_;  ///< of the lane along z; the old ones of its columns only
  std::vector<std::uint16_t> squares_;           ///< of the lane at one z
  std::vector<std::uint16_t> least_, reach_;     ///< at one z, by y
  std::vector<std::uint8_t> useful_;
  std::vector<int> nearest_;
};

}  // namespace clearway
