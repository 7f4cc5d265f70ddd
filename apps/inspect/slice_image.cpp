#include "apps/inspect/slice_image.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/inspect/slice_age.hpp"
#include "apps/inspect/slice_clearance.hpp"
#include "mapping/system/atomic_file.hpp"

namespace clearway {

namespace {

constexpr std::array<VoxelState, 5> states = {VoxelState::painted, VoxelState::occupied, VoxelState::conflict,
                                              VoxelState::seen_free, VoxelState::unknown};
constexpr int margin_left = SliceCanvas::margin_left, margin_top = SliceCanvas::margin_top;
constexpr int margin_bottom = SliceCanvas::margin_bottom, margin_right = SliceCanvas::margin_right;

cv::Scalar colour(VoxelState state) {  // RGB
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

void write_png(const cv::Mat& rgb, const std::filesystem::path& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(rgb.cols);
  image.height = static_cast<png_uint_32>(rgb.rows);
  image.format = PNG_FORMAT_RGB;
  const auto row = static_cast<png_int_32>(rgb.step[0]);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data, row, nullptr) == 0)
    throw std::runtime_error("cannot make the picture '" + file.string() + "': " + image.message);
  save_file(file, std::string_view(bytes).substr(0, size));
}

void put_text(cv::Mat& image, const std::string& text, cv::Point at, double scale = 0.42) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, {60, 60, 60}, 1, cv::LINE_AA);
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

SliceCanvas make_canvas(const Snapshot& map, const SlicePlane& plane, const Eigen::AlignedBox3d& bounds) {
  SliceCanvas canvas{};
  canvas.right = plane.axis == 0 ? 1 : 0;
  canvas.up = plane.axis == 2 ? 1 : 2;
  canvas.resolution = map.resolution();
  canvas.low_right = bounds.min()[canvas.right];
  canvas.low_up = bounds.min()[canvas.up];
  const Eigen::Vector3d size = bounds.sizes() / canvas.resolution;
  canvas.columns = static_cast<int>(std::lround(size[canvas.right]));
  canvas.rows = static_cast<int>(std::lround(size[canvas.up]));
  const double largest = std::max(canvas.columns, canvas.rows);
  canvas.pixels = largest <= 900.0 ? std::min(24.0, std::floor(900.0 / largest)) : 1400.0 / largest;
  canvas.pixels = std::max(canvas.pixels, 1400.0 / std::max(largest, 1400.0));
  return canvas;
}

void draw_axes(cv::Mat& image, const SliceCanvas& canvas) {
  const char* names = "xyz";
  const cv::Scalar ink(150, 150, 150);
  const auto draw = [&](double low, double span, bool horizontal) {
    const double step = tick_step(span, 6);
    for (double value = std::ceil(low / step) * step; value <= low + span + 1e-9; value += step) {
      const std::string label = significant(std::abs(value) < 1e-12 ? 0.0 : value);
      if (horizontal) {
        const int x = canvas.x(value), bottom = margin_top + canvas.height();
        cv::line(image, {x, bottom}, {x, bottom + 5}, ink);
        put_text(image, label, {x - 4 * static_cast<int>(label.size()), bottom + 19});
      } else {
        const int y = canvas.y(value);
        cv::line(image, {margin_left - 5, y}, {margin_left, y}, ink);
        put_text(image, label, {margin_left - 10 - 8 * static_cast<int>(label.size()), y + 4});
      }
    }
  };
  draw(canvas.low_right, canvas.columns * canvas.resolution, true);
  draw(canvas.low_up, canvas.rows * canvas.resolution, false);
  put_text(image, std::string(1, names[canvas.right]) + " [m]",
           {margin_left + canvas.width() / 2 - 12, image.rows - 8});
  put_text(image, std::string(1, names[canvas.up]) + " [m]", {8, margin_top - 10});
  cv::rectangle(image, {margin_left - 1, margin_top - 1},
                {margin_left + canvas.width(), margin_top + canvas.height()}, ink);
}

void draw_legend(cv::Mat& image, const SliceCanvas& canvas, const std::array<std::size_t, 5>& counts,
                 std::optional<Policy> policy, double step) {
  int y = margin_top + 12;
  const int x = margin_left + canvas.width() + 16;
  for (std::size_t s = 0; s < states.size(); ++s, y += 22) {
    cv::rectangle(image, {x, y - 10}, {x + 13, y + 3}, colour(states[s]), cv::FILLED);
    cv::rectangle(image, {x, y - 10}, {x + 13, y + 3}, {150, 150, 150});
    std::string name(to_string(states[s]));
    std::replace(name.begin(), name.end(), '_', ' ');
    put_text(image, name + "  " + grouped(counts[s]), {x + 20, y});
  }
  put_text(image, "voxel " + significant(canvas.resolution * 1000.0, 3) + " mm", {x, y + 6});
  if (!policy) return;
  std::string name(to_string(*policy));
  std::replace(name.begin(), name.end(), '_', ' ');
  put_text(image, "clearance, " + name + ":", {x, y + 38});
  put_text(image, "a line each " + significant(step * 1000.0, 3) + " mm", {x, y + 58});
}

cv::Scalar scalar(const AgeColours::Colour& colour) {
  return {double(colour[0]), double(colour[1]), double(colour[2])};
}

/// A bar of the colours below the legend of the states, with the ages at its ends.
void draw_age_legend(cv::Mat& image, const SliceCanvas& canvas, const AgeColours& colours) {
  constexpr int length = 150;
  const int x = margin_left + canvas.width() + 16;
  const int y = margin_top + 12 + 22 * static_cast<int>(states.size()) + 84;
  put_text(image, "seen free, last seen", {x, y});
  for (int i = 0; i < length; ++i) {
    const cv::Scalar ink = scalar(colours.of_age(colours.greatest_age() * i / (length - 1)));
    cv::line(image, {x + i, y + 8}, {x + i, y + 20}, ink);
  }
  put_text(image, "now", {x, y + 36});
  const std::string oldest = significant(colours.greatest_age(), 3) + " s ago";
  put_text(image, oldest, {x + length - 8 * static_cast<int>(oldest.size()), y + 36});
  cv::rectangle(image, {x, y + 50}, {x + 13, y + 63}, scalar(AgeColours::unknown), cv::FILLED);
  put_text(image, "not known when", {x + 20, y + 60});
}

}  // namespace

SlicePlane parse_slice(const std::string& text) {
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=') {
    throw std::invalid_argument("--slice: expected x=, y= or z= and metres, such as z=0.3, got '" + text +
                                "'");
  }
  const auto numbers = parse_numbers(text.substr(2), "--slice " + text.substr(0, 1));
  if (numbers.size() != 1)
    throw std::invalid_argument("--slice: expected one number after '" + text.substr(0, 2) + "'");
  return {text[0] - 'x', numbers[0]};
}

void write_slice_image(const Snapshot& map, const SlicePlane& plane, const std::filesystem::path& file,
                       std::optional<Policy> clearance, bool by_age) {
  if (file.extension() != ".png") {
    throw std::invalid_argument("--slice: expected a .png file, got '" + file.string() + "'");
  }
  const Eigen::AlignedBox3d bounds = map.bounds();
  if (bounds.isEmpty()) throw std::invalid_argument("--slice: the map is empty");
  if (plane.value < bounds.min()[plane.axis] || plane.value > bounds.max()[plane.axis]) {
    throw std::invalid_argument("--slice: " + significant(plane.value) + " m misses the map, which spans " +
                                significant(bounds.min()[plane.axis]) + " to " +
                                significant(bounds.max()[plane.axis]) + " m on that axis");
  }
  const std::optional<AgeColours> ages = by_age ? std::optional<AgeColours>(map) : std::nullopt;
  const SliceCanvas canvas = make_canvas(map, plane, bounds);
  const int least_height = ages ? 290 : 0;  // that the legend needs
  cv::Mat image(std::max(canvas.height(), least_height) + margin_top + margin_bottom,
                canvas.width() + margin_left + margin_right, CV_8UC3, cv::Scalar(250, 250, 250));
  std::array<std::size_t, 5> counts{};
  for (int row = 0; row < canvas.rows; ++row) {
    for (int column = 0; column < canvas.columns; ++column) {
      Eigen::Vector3d point;
      point[plane.axis] = plane.value;
      point[canvas.right] = canvas.low_right + (column + 0.5) * canvas.resolution;
      point[canvas.up] = canvas.low_up + (row + 0.5) * canvas.resolution;
      const VoxelState state = map.state(point);
      ++counts[static_cast<std::size_t>(std::find(states.begin(), states.end(), state) - states.begin())];
      const cv::Point low(
          margin_left + static_cast<int>(column * canvas.pixels),
          margin_top + canvas.height() - static_cast<int>(std::ceil((row + 1) * canvas.pixels)));
      const int side = std::max(1, static_cast<int>(std::ceil(canvas.pixels)));
      const bool aged = ages && state == VoxelState::seen_free;
      cv::rectangle(image, cv::Rect(low, cv::Size(side, side)),
                    aged ? scalar(ages->of(map.last_seen(point))) : colour(state), cv::FILLED);
    }
  }
  const double step = clearance ? draw_clearance(image, canvas, map, plane, *clearance) : 0.0;
  draw_axes(image, canvas);
  draw_legend(image, canvas, counts, clearance, step);
  if (ages) draw_age_legend(image, canvas, *ages);
  const char* names = "xyz";
  put_text(image, std::string("slice ") + names[plane.axis] + " = " + significant(plane.value) + " m",
           {margin_left, 20}, 0.5);
  write_png(image, file);
}

}  // namespace clearway
