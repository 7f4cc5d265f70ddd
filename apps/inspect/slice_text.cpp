#include <algorithm>

#include "apps/console/parse.hpp"
#include "apps/inspect/slice_states.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

char letter(VoxelState state) {
  switch (state) {
    case VoxelState::conflict:
      return 'X';
    case VoxelState::occupied:
      return '#';
    case VoxelState::painted:
      return '+';
    case VoxelState::seen_free:
      return '.';
    case VoxelState::unknown:
      return ' ';
  }
  return ' ';
}

/// Red, green and blue as terminals take them.
const char* terminal_colour(VoxelState state) {
  switch (state) {
    case VoxelState::conflict:
      return "214;48;49";
    case VoxelState::occupied:
      return "150;138;126";
    case VoxelState::painted:
      return "18;163;154";
    case VoxelState::seen_free:
      return "52;84;120";
    case VoxelState::unknown:
      return "18;22;27";
  }
  return "0;0;0";
}

std::string in_letters(const SlicePixels& pixels) {
  std::string text;
  for (int row = 0; row < pixels.height; ++row) {
    std::string line;
    for (int column = 0; column < pixels.width; ++column) line += letter(pixels.at(column, row));
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

std::string in_colours(const SlicePixels& pixels) {
  std::string text;
  for (int row = 0; row < pixels.height; row += 2) {
    for (int column = 0; column < pixels.width; ++column) {
      const VoxelState above = pixels.at(column, row);
      const VoxelState below = row + 1 < pixels.height ? pixels.at(column, row + 1) : VoxelState::unknown;
      text +=
          std::string("\033[38;2;") + terminal_colour(above) + ";48;2;" + terminal_colour(below) + "m\u2580";
    }
    text += "\033[0m\n";
  }
  return text;
}

}  // namespace

std::string slice_legend(bool colours, bool shows_difference) {
  std::string text;
  for (const VoxelState state : slice_states) {
    const std::string name = slice_label(state, shows_difference);
    if (!text.empty()) text += "  ";
    if (colours)
      text += std::string("\033[38;2;") + terminal_colour(state) + "m\u2588\u2588\033[0m " + name;
    else
      text +=
          (state == VoxelState::unknown ? std::string("blank") : std::string(1, letter(state))) + " " + name;
  }
  return text + "\n";
}

std::string slice_caption(const MapLeaves& map, const SlicePlane& plane) {
  const SliceFrame frame = slice_frame(map, plane);
  const double voxel = map.resolution();
  const auto name = [](int axis) { return std::string(1, static_cast<char>('x' + axis)); };
  const auto span = [&](int axis, int voxels) {
    return name(axis) + ", " + place_text(frame.low[axis] * voxel) + " to " +
           place_text((frame.low[axis] + voxels) * voxel) + " m";
  };
  return name(plane.axis) + " = " + place_text(plane.value) + " m; to the right " +
         span(frame.right, frame.columns) + "; upwards " + span(frame.up, frame.rows) + "\n";
}

std::string slice_text(const MapLeaves& map, const SlicePlane& plane, int columns, bool colours,
                       bool shows_difference) {
  require_plane(map, plane, "--term");
  const SliceFrame frame = slice_frame(map, plane);
  // Two characters a voxel at most; a character is twice as high as wide.
  const double across = std::min(2.0, static_cast<double>(columns) / frame.columns);
  const SlicePixels pixels =
      slice_pixels(map, plane, across, colours ? across : across / 2.0, shows_difference);
  const std::string beyond = beyond_text(pixels);
  return (colours ? in_colours(pixels) : in_letters(pixels)) + beyond + (beyond.empty() ? "" : "\n");
}

}  // namespace clearway
