#include "apps/inspect/slice_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/inspect/picture.hpp"
#include "apps/inspect/slice_age.hpp"
#include "apps/inspect/slice_clearance.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {

namespace {

/// In the order of the legend.
constexpr std::array<VoxelState, 5> states = {VoxelState::painted, VoxelState::occupied, VoxelState::conflict,
                                              VoxelState::seen_free, VoxelState::unknown};
constexpr int margin_left = SliceCanvas::margin_left, margin_top = SliceCanvas::margin_top;
constexpr int label_gap = 7;  ///< pixels, between labels of ticks
constexpr int margin_bottom = SliceCanvas::margin_bottom, margin_right = SliceCanvas::margin_right;

Picture::Colour colour(VoxelState state) {
  switch (state) {
    case VoxelState::painted:
      return {64, 176, 166};
    case VoxelState::occupied:
      return {74, 68, 64};
    case VoxelState::conflict:
      return {214, 48, 49};
    case VoxelState::seen_free:
      return {222, 235, 247};
    case VoxelState::unknown:
      return {255, 255, 255};
  }
  return {255, 255, 255};
}

/// A step of 1, 2 or 5 times a power of ten that puts about `count` ticks on `span`.
double tick_step(double span, int count) {
  const double raw = span / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10.0 * power;
}

SliceCanvas make_canvas(const MapLeaves& map, const SlicePlane& plane) {
  const SliceFrame frame = slice_frame(map, plane);
  SliceCanvas canvas{};
  canvas.right = frame.right;
  canvas.up = frame.up;
  canvas.columns = frame.columns;
  canvas.rows = frame.rows;
  canvas.resolution = map.resolution();
  canvas.low_right = frame.low[frame.right] * canvas.resolution;
  canvas.low_up = frame.low[frame.up] * canvas.resolution;
  const double largest = std::max(canvas.columns, canvas.rows);
  canvas.pixels = largest <= 900.0 ? std::min(24.0, std::floor(900.0 / largest)) : 1400.0 / largest;
  return canvas;
}

void draw_axes(Picture& image, const SliceCanvas& canvas) {
  const char* names = "xyz";
  constexpr Picture::Colour ink{150, 150, 150};
  const auto draw = [&](double low, double span, bool horizontal) {
    const double step = tick_step(span, 6);
    int written = horizontal ? -label_gap : margin_top + canvas.height() + 2 * label_gap;  // up to where
    for (double value = std::ceil(low / step) * step; value <= low + span + 1e-9; value += step) {
      const std::string label = significant(std::abs(value) < 1e-12 ? 0.0 : value);
      if (horizontal) {
        const int x = canvas.x(value), bottom = margin_top + canvas.height();
        image.fill(x, bottom, x, bottom + 5, ink);
        const int half = Picture::text_width(label) / 2;
        if (x - half < written + label_gap) continue;
        image.write(label, x - half, bottom + 19);
        written = x + half;
      } else {
        const int y = canvas.y(value);
        image.fill(margin_left - 5, y, margin_left, y, ink);
        if (y > written - 2 * label_gap) continue;
        written = y;
        image.write(label, margin_left - 9 - Picture::text_width(label), y + 4);
      }
    }
  };
  draw(canvas.low_right, canvas.columns * canvas.resolution, true);
  draw(canvas.low_up, canvas.rows * canvas.resolution, false);
  image.write(std::string(1, names[canvas.right]) + " [m]", margin_left + canvas.width() / 2 - 12,
              margin_top + canvas.height() + 38);
  image.write(std::string(1, names[canvas.up]) + " [m]", 8, margin_top - 10);
  image.outline(margin_left - 1, margin_top - 1, margin_left + canvas.width(), margin_top + canvas.height(),
                ink);
}

/// Returns where the legend ends.
int draw_legend(Picture& image, const SliceCanvas& canvas, const SlicePixels& pixels, const SliceLook& look,
                double step) {
  int y = margin_top + 12;
  const int x = margin_left + canvas.width() + 16;
  for (const VoxelState state : states) {
    const auto at = std::find(slice_states.begin(), slice_states.end(), state) - slice_states.begin();
    image.fill(x, y - 10, x + 13, y + 3, colour(state));
    image.outline(x, y - 10, x + 13, y + 3, {150, 150, 150});
    const std::string name = slice_label(state, look.shows_difference);
    image.write(name + "  " + grouped(pixels.counts[static_cast<std::size_t>(at)]), x + 20, y + 1);
    y += 22;
  }
  const auto line = [&](const std::string& text) {
    image.write(text, x, y + 6);
    y += 20;
  };
  line("voxel " + significant(canvas.resolution * 1000.0, 3) + " mm");
  if (canvas.pixels < 1.0) {
    line("pixel " + significant(canvas.resolution * 1000.0 / canvas.pixels, 3) + " mm:");
    line("what blocks hides the rest");
  }
  for (std::size_t i = 0; i < slice_states.size(); ++i)
    if (pixels.beyond[i] > 0)
      line("outside: " + grouped(pixels.beyond[i]) + " " +
           slice_label(slice_states[i], look.shows_difference));
  if (!look.clearance) return y;
  y += 12;
  line("clearance, " + spoken(to_string(*look.clearance)) + ":");
  line("a line each " + significant(step * 1000.0, 3) + " mm");
  return y;
}

/// A bar of the colours below the legend of the states, with the ages at its ends.
void draw_age_legend(Picture& image, const SliceCanvas& canvas, int y, const AgeColours& colours) {
  constexpr int length = 150;
  const int x = margin_left + canvas.width() + 16;
  image.write("seen free, last seen", x, y);
  for (int i = 0; i < length; ++i) {
    image.fill(x + i, y + 8, x + i, y + 20, colours.of_age(colours.greatest_age() * i / (length - 1)));
  }
  image.write("now", x, y + 36);
  const std::string oldest = significant(colours.greatest_age(), 3) + " s ago";
  image.write(oldest, x + length - Picture::text_width(oldest), y + 36);
  image.fill(x, y + 50, x + 13, y + 63, AgeColours::unknown);
  image.write("not known when", x + 20, y + 61);
}

void draw_voxels(Picture& image, const SliceCanvas& canvas, const MapLeaves& map, const SlicePlane& plane,
                 const SlicePixels& pixels, const std::optional<AgeColours>& ages) {
  for (int row = 0; row < pixels.height; ++row) {
    for (int column = 0; column < pixels.width; ++column) {
      const VoxelState state = pixels.at(column, row);
      Picture::Colour ink = colour(state);
      if (ages && state == VoxelState::seen_free) {
        Eigen::Vector3d point;
        point[plane.axis] = plane.value;
        point[canvas.right] = canvas.right_at(margin_left + column);
        point[canvas.up] = canvas.up_at(margin_top + row);
        ink = ages->of(map.about().last_seen(point));
      }
      image.set(margin_left + column, margin_top + row, ink);
    }
  }
}

}  // namespace

SlicePlane parse_slice(const std::string& text) { return parse_plane(text, "--slice"); }

std::string write_slice_image(const MapLeaves& map, const SlicePlane& plane,
                              const std::filesystem::path& file, const SliceLook& look) {
  if (extension_of(file) != ".png") {
    throw std::invalid_argument("--slice: expected a .png file, got '" + file.string() + "'");
  }
  require_plane(map, plane, "--slice");
  const std::optional<AgeColours> ages = look.by_age ? std::optional<AgeColours>(map.about()) : std::nullopt;
  const SliceCanvas canvas = make_canvas(map, plane);
  const SlicePixels pixels = slice_pixels(map, plane, canvas.pixels, canvas.pixels, look.shows_difference);
  const int least_height = 170 + (look.clearance ? 60 : 0) + (ages ? 90 : 0);  // that the legend needs
  Picture image(canvas.width() + margin_left + margin_right,
                std::max(canvas.height(), least_height) + margin_top + margin_bottom, {250, 250, 250});
  draw_voxels(image, canvas, map, plane, pixels, ages);
  const double step =
      look.clearance ? draw_clearance(image, canvas, map.about(), plane, *look.clearance) : 0.0;
  draw_axes(image, canvas);
  const int end = draw_legend(image, canvas, pixels, look, step);
  if (ages) draw_age_legend(image, canvas, end + 22, *ages);
  const char* names = "xyz";
  std::string title = look.name;
  if (!title.empty()) title += ", ";
  title += std::string(1, names[plane.axis]) + " = " + significant(plane.value) + " m";
  image.write(Picture::shortened(title, image.width() - margin_left - 10, 14), margin_left, 21, 14);
  save_file(file, image.png());
  return beyond_text(pixels);
}

}  // namespace clearway
