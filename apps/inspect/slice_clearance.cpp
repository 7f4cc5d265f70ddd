#include "apps/inspect/slice_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace clearway {
namespace {

/// The lines are this many voxels apart, and end after so many.
constexpr double voxels_a_line = 2.0;
constexpr int lines = 16;

/// Number of the band between two lines that each pixel lies in; -1 for blocked.
std::vector<std::int16_t> bands(const SliceCanvas& canvas, const BlockedSpace& space, const SlicePlane& plane,
                                double step) {
  std::vector<std::int16_t> result;
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) {
      Eigen::Vector3d point;
      point[plane.axis] = plane.value;
      point[canvas.right] = canvas.right_at(SliceCanvas::margin_left + column);
      point[canvas.up] = canvas.up_at(SliceCanvas::margin_top + row);
      const double clearance = space.clearance(point);
      const bool blocked = clearance <= 0.0 && space.is_blocked(point);
      result.push_back(
          static_cast<std::int16_t>(blocked ? -1 : static_cast<int>(std::floor(clearance / step))));
    }
  }
  return result;
}

}  // namespace

double draw_clearance(Picture& image, const SliceCanvas& canvas, const Snapshot& map, const SlicePlane& plane,
                      Policy policy) {
  const double step = voxels_a_line * map.resolution();
  const double reach = step * (lines + 1);
  Eigen::AlignedBox3d region = map.bounds();
  region.min()[plane.axis] = std::max(region.min()[plane.axis], plane.value - reach);
  region.max()[plane.axis] = std::min(region.max()[plane.axis], plane.value + reach);
  const auto space = map.blocked_space({policy, 0xffff}, region, reach);
  const std::vector<std::int16_t> band = bands(canvas, *space, plane, step);
  const auto band_at = [&](int column, int row) {
    return int{band[static_cast<std::size_t>(row) * static_cast<std::size_t>(canvas.width()) +
                    static_cast<std::size_t>(column)]};
  };
  constexpr Picture::Colour ink{196, 120, 32};
  for (int row = 0; row + 1 < canvas.height(); ++row) {
    for (int column = 0; column + 1 < canvas.width(); ++column) {
      const int here = band_at(column, row);
      for (const int there : {band_at(column + 1, row), band_at(column, row + 1)}) {
        const int line = std::max(here, there);
        if (here == there || std::min(here, there) < 0 || line > lines) continue;
        const int x = SliceCanvas::margin_left + column, y = SliceCanvas::margin_top + row;
        image.set(x, y, ink);
        if (line % 4 == 0) image.set(x + 1, y + 1, ink);
      }
    }
  }
  return step;
}

}  // namespace clearway
