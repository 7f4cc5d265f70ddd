#include "apps/inspect/slice_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

/// The lines are this many voxels apart, and end after so many; of every fourth one the clearance is written.
constexpr double voxels_a_line = 2.0;
constexpr int lines = 16, lines_a_label = 4;
constexpr Picture::Colour ink{196, 120, 32}, paper{250, 250, 250};

/// The clearance in a slice: looked up in the middle of each voxel, or of each pixel where these are larger,
/// and linear between, because the bound has small steps inside of voxels.
class ClearanceSlice {
 public:
  ClearanceSlice(const SliceCanvas& canvas, const BlockedSpace& space, const SlicePlane& plane)
      : canvas_(canvas),
        spacing_(canvas.resolution * std::max(1.0, 1.0 / canvas.pixels)),
        columns_(nodes_along(canvas.columns)),
        rows_(nodes_along(canvas.rows)) {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        Eigen::Vector3d point;
        point[plane.axis] = plane.value;
        point[canvas.right] = canvas.low_right + (column + 0.5) * spacing_;
        point[canvas.up] = canvas.low_up + (row + 0.5) * spacing_;
        values_.push_back(space.is_blocked(point) ? 0.0 : space.clearance(point));
      }
    }
  }

  /// At a place of the picture, in pixels.
  double at(double x, double y) const {
    const double per_pixel = canvas_.resolution / canvas_.pixels / spacing_;
    const double right = (x - SliceCanvas::margin_left + 0.5) * per_pixel - 0.5;
    const double up = (SliceCanvas::margin_top + canvas_.height() - y - 0.5) * per_pixel - 0.5;
    const int column = std::clamp(static_cast<int>(std::floor(right)), 0, std::max(0, columns_ - 2));
    const int row = std::clamp(static_cast<int>(std::floor(up)), 0, std::max(0, rows_ - 2));
    const double a = std::clamp(right - column, 0.0, 1.0), b = std::clamp(up - row, 0.0, 1.0);
    const auto node = [&](int i, int j) {
      return values_[static_cast<std::size_t>(std::min(row + j, rows_ - 1)) *
                         static_cast<std::size_t>(columns_) +
                     static_cast<std::size_t>(std::min(column + i, columns_ - 1))];
    };
    return (1 - b) * ((1 - a) * node(0, 0) + a * node(1, 0)) + b * ((1 - a) * node(0, 1) + a * node(1, 1));
  }

 private:
  int nodes_along(int voxels) const {
    return std::max(1, static_cast<int>(std::lround(voxels * canvas_.resolution / spacing_)));
  }

  const SliceCanvas& canvas_;
  double spacing_;
  int columns_, rows_;
  std::vector<double> values_;
};

/// The line nearest to a pixel, and how far it is, pixels; none on level ground.
struct NearLine {
  int number = 0;
  double distance = HUGE_VAL;
};
NearLine line_near(const ClearanceSlice& slice, double step, double pixel, int x, int y) {
  const double value = slice.at(x, y);
  const int number = static_cast<int>(std::lround(value / step));
  if (number < 1 || number > lines) return {};
  const double slope =
      std::hypot(slice.at(x + 0.5, y) - slice.at(x - 0.5, y), slice.at(x, y + 0.5) - slice.at(x, y - 0.5));
  if (slope < 0.1 * pixel) return {};  // level ground
  return {number, std::abs(value - number * step) / slope};
}

void blend(Picture& image, int x, int y, double share) {
  Picture::Colour colour = image.at(x, y);
  for (std::size_t i = 0; i < 3; ++i)
    colour[i] = static_cast<std::uint8_t>(std::lround((1.0 - share) * colour[i] + share * ink[i]));
  image.set(x, y, colour);
}

struct Pixel {
  int x, y;
};

/// Writes the line's clearance on it, in the first place near the middle of the picture where the text hides
/// nothing that is nearer to obstacles than the line before.
void write_label(Picture& image, const SliceCanvas& canvas, const ClearanceSlice& slice, double clearance,
                 double step, std::vector<Pixel> on_line) {
  constexpr int size = 10, half_height = 6;
  const std::string text = short_text(1e3 * clearance, 4);
  const int half_width = Picture::text_width(text, size) / 2 + 2;
  const int left = SliceCanvas::margin_left, top = SliceCanvas::margin_top;
  const auto from_middle = [&](const Pixel& pixel) {
    return std::hypot(pixel.x - left - canvas.width() / 2, pixel.y - top - canvas.height() / 2);
  };
  std::stable_sort(on_line.begin(), on_line.end(),
                   [&](const Pixel& a, const Pixel& b) { return from_middle(a) < from_middle(b); });
  const auto fits = [&](const Pixel& at) {
    if (at.x - half_width < left || at.x + half_width >= left + canvas.width()) return false;
    if (at.y - half_height < top || at.y + half_height >= top + canvas.height()) return false;
    for (const int x : {at.x - half_width, at.x + half_width})
      for (const int y : {at.y - half_height, at.y + half_height})
        if (std::abs(slice.at(x, y) - clearance) > step * (lines_a_label - 1)) return false;
    return true;
  };
  const auto place = std::find_if(on_line.begin(), on_line.end(), fits);
  if (place == on_line.end()) return;
  image.fill(place->x - half_width, place->y - half_height, place->x + half_width, place->y + half_height,
             paper);
  image.write(text, place->x - half_width + 2, place->y + 4, size);
}

}  // namespace

double draw_clearance(Picture& image, const SliceCanvas& canvas, const Snapshot& map, const SlicePlane& plane,
                      Policy policy) {
  const double step = voxels_a_line * map.resolution();
  const double reach = step * (lines + 1);
  Eigen::AlignedBox3d region = map.bounds();
  region.min()[canvas.right] = std::max(region.min()[canvas.right], canvas.low_right - reach);
  region.max()[canvas.right] =
      std::min(region.max()[canvas.right], canvas.low_right + canvas.columns * canvas.resolution + reach);
  region.min()[canvas.up] = std::max(region.min()[canvas.up], canvas.low_up - reach);
  region.max()[canvas.up] =
      std::min(region.max()[canvas.up], canvas.low_up + canvas.rows * canvas.resolution + reach);
  region.min()[plane.axis] = std::max(region.min()[plane.axis], plane.value - reach);
  region.max()[plane.axis] = std::min(region.max()[plane.axis], plane.value + reach);
  const auto space = map.blocked_space({policy, 0xffff}, region, reach);
  const ClearanceSlice slice(canvas, *space, plane);
  std::vector<std::vector<Pixel>> labelled(lines + 1);
  for (int y = SliceCanvas::margin_top; y < SliceCanvas::margin_top + canvas.height(); ++y) {
    for (int x = SliceCanvas::margin_left; x < SliceCanvas::margin_left + canvas.width(); ++x) {
      const NearLine line = line_near(slice, step, map.resolution() / canvas.pixels, x, y);
      const bool is_thick = line.number % lines_a_label == 0;
      const double share = std::clamp((is_thick ? 1.5 : 1.0) - line.distance, 0.0, 1.0);
      if (share > 0.0) blend(image, x, y, share);
      if (is_thick && line.distance < 0.5) labelled[static_cast<std::size_t>(line.number)].push_back({x, y});
    }
  }
  for (int line = lines_a_label; line <= lines; line += lines_a_label)
    write_label(image, canvas, slice, line * step, step, std::move(labelled[static_cast<std::size_t>(line)]));
  return step;
}

}  // namespace clearway
