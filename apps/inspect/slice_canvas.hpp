#pragma once

#include <algorithm>
#include <cmath>

namespace clearway {

/// The frame of a slice's picture: which map axes run right and up, and how many pixels a voxel takes.
struct SliceCanvas {
  static constexpr int margin_left = 70, margin_top = 34, margin_bottom = 46, margin_right = 190;

  int right, up, columns, rows;
  double low_right, low_up, resolution, pixels;

  int x(double metres) const {
    return margin_left + static_cast<int>(std::lround((metres - low_right) / resolution * pixels));
  }
  int y(double metres) const {
    return margin_top + height() - static_cast<int>(std::lround((metres - low_up) / resolution * pixels));
  }
  /// The map's coordinates in the middle of a pixel.
  double right_at(int x) const { return low_right + (x - margin_left + 0.5) / pixels * resolution; }
  double up_at(int y) const { return low_up + (margin_top + height() - y - 0.5) / pixels * resolution; }

  int width() const { return std::max(1, static_cast<int>(std::lround(columns * pixels))); }
  int height() const { return std::max(1, static_cast<int>(std::lround(rows * pixels))); }
};

}  // namespace clearway
