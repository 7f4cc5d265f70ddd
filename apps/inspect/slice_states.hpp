#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mapping/files/map_leaves.hpp"

namespace clearway {

/// A plane through the map: the axis (0 x, 1 y, 2 z) it is perpendicular to, and where, metres.
struct SlicePlane {
  int axis = 2;
  double value = 0.0;
  bool is_whole = false;  ///< drawn up to the farthest voxel, else as far as MapLeaves::main_bounds
};

/// Parses "z=0.3". @throws std::invalid_argument naming `flag`, with the expected form.
SlicePlane parse_plane(const std::string& text, const std::string& flag);

/// Throws std::invalid_argument naming `flag` when the map is empty or the plane misses it (with its range).
void require_plane(const MapLeaves& map, const SlicePlane& plane, const std::string& flag);

/// The states, what hides most first: the order in which they are drawn over each other where several voxels
/// share a pixel, so that nothing blocked is lost.
inline constexpr std::array<VoxelState, 5> slice_states = {VoxelState::conflict, VoxelState::occupied,
                                                           VoxelState::painted, VoxelState::seen_free,
                                                           VoxelState::unknown};

/// What a state of MapLeaves::difference means.
std::string difference_label(VoxelState state);

/// The voxels in a plane, as pixels.
struct SlicePixels {
  int width = 0, height = 0;
  std::vector<VoxelState> states;       ///< row by row, the highest first
  std::array<std::size_t, 5> counts{};  ///< voxels in the picture by state, as in `slice_states`
  std::array<std::size_t, 5> beyond{};  ///< the same of the plane's known voxels outside of the picture

  VoxelState at(int column, int row) const {
    return states[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
};

/// The axes of a plane's picture and the voxels that it spans.
struct SliceFrame {
  int right = 0, up = 0;  ///< map axes
  int columns = 0, rows = 0;
  Eigen::Vector3i low = Eigen::Vector3i::Zero();  ///< the lowest of them
};
SliceFrame slice_frame(const MapLeaves& map, const SlicePlane& plane);

/// "seen_free" as "seen free".
std::string spoken(std::string_view name);

/// The state as people say it: "seen free"; of a difference, as difference_label.
std::string slice_label(VoxelState state, bool shows_difference);

/// "14 voxels (3 occupied, 11 seen free) lie outside; --whole shows them", where there are some.
std::string beyond_text(const SlicePixels& pixels);

/// What slice_text shows: "z = 0.3 m; to the right x, -0.26 to 0.14 m; upwards y, 0 to 0.6 m".
std::string slice_caption(const MapLeaves& map, const SlicePlane& plane);

/// Which letter, or colour, of slice_text stands for which state, in one line.
std::string slice_legend(bool colours, bool shows_difference);

/// The plane as text, a line a row: of `columns` characters, or as few as its voxels need. With `colours` of
/// 24 bits for terminals, each character two pixels one above the other; else # occupied, X conflict, +
/// painted, . seen free.
std::string slice_text(const MapLeaves& map, const SlicePlane& plane, int columns, bool colours,
                       bool shows_difference = false);

/// Looks at the leaves that the plane cuts, as they are stored.
/// A pixel that several voxels touch shows what blocks where any of them does, seen free and painted only
/// where all of it is.
/// @param across, upward pixels a voxel takes; may be less than one
/// @param shows_difference the states stand for changes: each is shown where any voxel has it
SlicePixels slice_pixels(const MapLeaves& map, const SlicePlane& plane, double across, double upward,
                         bool shows_difference = false);

}  // namespace clearway
