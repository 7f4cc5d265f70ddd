#include "apps/inspect/slice_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

std::size_t rank(VoxelState state) {
  return static_cast<std::size_t>(std::find(slice_states.begin(), slice_states.end(), state) -
                                  slice_states.begin());
}

/// The pixels that voxels first ... first + edge - 1 touch.
std::pair<int, int> pixels_of(int first, int edge, double scale, int size) {
  const int low = std::clamp(static_cast<int>(std::floor(first * scale + 1e-9)), 0, size - 1);
  const int high = static_cast<int>(std::ceil((first + edge) * scale - 1e-9));
  return {low, std::clamp(high, low + 1, size)};
}

/// How much of pixel `at` the voxels first ... first + edge - 1 cover, 0 to 1.
double covered(int at, int first, int edge, double scale) {
  return std::clamp(std::min(at + 1.0, (first + edge) * scale) - std::max<double>(at, first * scale), 0.0,
                    1.0);
}

}  // namespace

SlicePlane parse_plane(const std::string& text, const std::string& flag) {
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=')
    throw std::invalid_argument(flag + ": expected x=, y= or z= and metres, such as z=0.3, got '" + text +
                                "'");
  const auto numbers = parse_numbers(text.substr(2), flag + " " + text.substr(0, 1));
  if (numbers.size() != 1)
    throw std::invalid_argument(flag + ": expected one number after '" + text.substr(0, 2) + "'");
  return {text[0] - 'x', numbers[0]};
}

void require_plane(const MapLeaves& map, const SlicePlane& plane, const std::string& flag) {
  const Eigen::AlignedBox3d bounds = map.bounds();
  if (bounds.isEmpty()) throw std::invalid_argument(flag + ": the map is empty");
  if (plane.value >= bounds.min()[plane.axis] && plane.value <= bounds.max()[plane.axis]) return;
  throw std::invalid_argument(flag + ": " + place_text(plane.value) + " m misses the map, which spans " +
                              place_text(bounds.min()[plane.axis]) + " to " +
                              place_text(bounds.max()[plane.axis]) + " m on that axis");
}

std::string spoken(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string slice_label(VoxelState state, bool shows_difference) {
  return shows_difference ? difference_label(state) : spoken(to_string(state));
}

std::string difference_label(VoxelState state) {
  switch (state) {
    case VoxelState::conflict:
      return "newly blocked";
    case VoxelState::painted:
      return "blocked no more";
    case VoxelState::occupied:
      return "blocked in both";
    case VoxelState::seen_free:
      return "other change";
    case VoxelState::unknown:
      return "same";
  }
  return "";
}

SliceFrame slice_frame(const MapLeaves& map, const SlicePlane& plane) {
  SliceFrame frame;
  frame.right = plane.axis == 0 ? 1 : 0;
  frame.up = plane.axis == 2 ? 1 : 2;
  const Eigen::AlignedBox3d bounds = map.bounds();
  if (bounds.isEmpty()) return frame;
  for (int axis = 0; axis < 3; ++axis)
    frame.low[axis] = static_cast<int>(std::lround(bounds.min()[axis] / map.resolution()));
  frame.columns = static_cast<int>(std::lround(bounds.sizes()[frame.right] / map.resolution()));
  frame.rows = static_cast<int>(std::lround(bounds.sizes()[frame.up] / map.resolution()));
  return frame;
}

SlicePixels slice_pixels(const MapLeaves& map, const SlicePlane& plane, double across, double upward,
                         bool shows_difference) {
  const SliceFrame frame = slice_frame(map, plane);
  SlicePixels pixels;
  pixels.width = std::max(1, static_cast<int>(std::lround(frame.columns * across)));
  pixels.height = std::max(1, static_cast<int>(std::lround(frame.rows * upward)));
  const auto width = static_cast<std::size_t>(pixels.width);
  std::vector<std::uint8_t> ranks(width * static_cast<std::size_t>(pixels.height), slice_states.size() - 1);
  std::vector<double> painted(ranks.size()), known(ranks.size());  // shares that are painted, that are either
  const auto cell = map.about().tree().cell(plane.value * Eigen::Vector3d::Unit(plane.axis));
  const int layer = cell ? (*cell)[plane.axis] : std::numeric_limits<int>::max();
  pixels.counts.back() = static_cast<std::size_t>(frame.columns) * static_cast<std::size_t>(frame.rows);
  map.visit([&](const MapLeaf& leaf) {
    if (layer < leaf.corner[plane.axis] || layer >= leaf.corner[plane.axis] + leaf.edge) return;
    const std::size_t state = rank(leaf.state);
    const std::size_t voxels = static_cast<std::size_t>(leaf.edge) * static_cast<std::size_t>(leaf.edge);
    pixels.counts[state] += voxels;
    pixels.counts.back() -= voxels;
    const auto [left, right] =
        pixels_of(leaf.corner[frame.right] - frame.low[frame.right], leaf.edge, across, pixels.width);
    const auto [bottom, top] =
        pixels_of(leaf.corner[frame.up] - frame.low[frame.up], leaf.edge, upward, pixels.height);
    const bool is_anywhere =
        shows_difference || leaf.state == VoxelState::occupied || leaf.state == VoxelState::conflict;
    const int from = leaf.corner[frame.right] - frame.low[frame.right],
              low = leaf.corner[frame.up] - frame.low[frame.up];
    for (int up = bottom; up < top; ++up) {
      const std::size_t row = static_cast<std::size_t>(pixels.height - 1 - up) * width;
      for (int column = left; column < right; ++column) {
        const std::size_t at = row + static_cast<std::size_t>(column);
        if (is_anywhere) {
          ranks[at] = std::min(ranks[at], static_cast<std::uint8_t>(state));
          continue;
        }
        const double share = covered(column, from, leaf.edge, across) * covered(up, low, leaf.edge, upward);
        known[at] += share;
        if (leaf.state == VoxelState::painted) painted[at] += share;
      }
    }
  });
  // Free is only what is so wholly, as far as the map goes: nothing unknown may look free.
  for (int row = 0; row < pixels.height; ++row)
    for (int column = 0; column < pixels.width; ++column) {
      const std::size_t at = static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
      if (ranks[at] + 1U < slice_states.size()) continue;
      const double whole = covered(column, 0, frame.columns, across) *
                               covered(pixels.height - 1 - row, 0, frame.rows, upward) -
                           1e-6;
      if (known[at] >= whole)
        ranks[at] = static_cast<std::uint8_t>(
            rank(painted[at] >= whole ? VoxelState::painted : VoxelState::seen_free));
    }
  pixels.states.reserve(ranks.size());
  for (const std::uint8_t each : ranks) pixels.states.push_back(slice_states[each]);
  return pixels;
}

}  // namespace clearway
