#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapping/system/instruction_set.hpp"

namespace clearway {

/// Cells that the hot loops take at once: 32 neighbours along x.
constexpr int lane_cells = 32;

/// Largest cap for which no intermediate sum leaves 16 bits: distances up to 90.5 voxels.
constexpr std::uint16_t largest_cap = 32767;

/// Squared distance along one axis, in half voxels, from a cell's centre to the cube `steps` cells away.
constexpr int gap_squared(int steps) { return steps == 0 ? 0 : (2 * steps - 1) * (2 * steps - 1); }

/// The steps of an exact distance transform, truncated at `cap`: the sum over the axes of
/// max(2|delta| - 1, 0)^2, which is the squared distance from a cell's centre to a blocked cube in half
/// voxels. Separable over the axes (Saito and Toriwaki 1994): along the first axis cells are counted, along
/// the two others the least sum is taken within a window that the cap bounds.
class DistanceAxes {
 public:
  /// @param cap 1 to largest_cap.
  explicit DistanceAxes(std::uint16_t cap, InstructionSet vectors = best_instruction_set());

  std::uint16_t cap() const { return cap_; }

  /// Cells on either side that can matter: beyond them a gap alone reaches the cap.
  int window() const { return window_; }

  /// Cells that lower() may read on either side of those that it is asked for.
  int margin() const { return window_ + unroll; }

  /// First axis, from the cells' bits: `words[i * lines + l]` holds the 32 cells of line l at step i along
  /// the axis. Writes for each cell how many steps the nearest set bit is away along the axis, at most
  /// window() + 1.
  void count_steps(const std::uint32_t* words, int lines, int count, std::uint8_t* steps) const;

  /// Squares 32 steps. Returns true when any of them is below the cap.
  bool square_steps(const std::uint8_t* steps, std::uint16_t* squared) const;

  /// True when any of 32 numbers is at least `value`.
  bool any_at_least(const std::uint16_t* numbers, std::uint16_t value) const {
    return value == 0 || above_(numbers, static_cast<std::uint16_t>(value - 1));
  }

  /// Second and third axis, for 32 cells: out[k] = min over |d| <= window() of
  /// center[k + d * stride] + gap_squared(d), where nothing nearer than `nearest` steps needs looking at but
  /// the cells themselves. Reads margin() strides either side. `out` must not overlap the input.
  void lower(const std::uint16_t* center, std::ptrdiff_t stride, int nearest, std::uint16_t* out) const {
    lower_(center, stride, gaps_.data(), nearest, window_, out);
  }

 private:
  static constexpr int unroll = 4;
  using Lower = void (*)(const std::uint16_t*, std::ptrdiff_t, const std::uint16_t*, int, int,
                         std::uint16_t*);
  using Count = void (*)(const std::uint32_t*, int, int, int, std::uint8_t*);
  using Square = void (*)(const std::uint8_t*, int, std::uint16_t, std::uint16_t*);

  using Above = bool (*)(const std::uint16_t*, std::uint16_t);

  std::uint16_t cap_;
  int window_;
  Lower lower_;
  Above above_;
  Count count_;
  Square square_;
  std::vector<std::uint16_t> gaps_;  ///< squared, by steps; a few beyond the window
};

}  // namespace clearway
