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

std::string beyond_text(const SlicePixels& pixels) {
  std::string text;
  std::size_t all = 0;
  for (std::size_t i = 0; i < slice_states.size(); ++i) {
    if (pixels.beyond[i] == 0) continue;
    text += (text.empty() ? "" : ", ") + grouped(pixels.beyond[i]) + " " + spoken(to_string(slice_states[i]));
    all += pixels.beyond[i];
  }
  if (all == 0) return {};
  return counted(all, "voxel") + " (" + text + ") " + (all == 1 ? "lies" : "lie") +
         " outside; --whole shows " + (all == 1 ? "it" : "them");
}

SliceFrame slice_frame(const MapLeaves& map, const SlicePlane& plane) {
  SliceFrame frame;
  frame.right = plane.axis == 0 ? 1 : 0;
  frame.up = plane.axis == 2 ? 1 : 2;
  const Eigen::AlignedBox3d bounds = plane.is_whole ? map.bounds() : map.main_bounds();
  if (bounds.isEmpty()) return frame;
  for (int axis = 0; axis < 3; ++axis)
    frame.low[axis] = static_cast<int>(std::lround(bounds.min()[axis] / map.resolution()));
  frame.columns = static_cast<int>(std::lround(bounds.sizes()[frame.right] / map.resolution()));
  frame.rows = static_cast<int>(std::lround(bounds.sizes()[frame.up] / map.resolution()));
  return frame;
}

namespace {

/// The pixels of a plane while its leaves come.
class SliceRaster {
 public:
  SliceRaster(const MapLeaves& map, const SlicePlane& plane, double across, double upward,
              bool shows_difference)
      : frame_(slice_frame(map, plane)),
        axis_(plane.axis),
        across_(across),
        upward_(upward),
        shows_difference_(shows_difference) {
    if (const auto cell = map.about().tree().cell(plane.value * Eigen::Vector3d::Unit(axis_)))
      layer_ = (*cell)[axis_];
    pixels_.width = std::max(1, static_cast<int>(std::lround(frame_.columns * across)));
    pixels_.height = std::max(1, static_cast<int>(std::lround(frame_.rows * upward)));
    pixels_.counts.back() = static_cast<std::size_t>(frame_.columns) * static_cast<std::size_t>(frame_.rows);
    ranks_.resize(static_cast<std::size_t>(pixels_.width) * static_cast<std::size_t>(pixels_.height),
                  slice_states.size() - 1);
    painted_.resize(ranks_.size());
    known_.resize(ranks_.size());
  }

  void add(const MapLeaf& leaf) {
    if (layer_ < leaf.corner[axis_] || layer_ >= leaf.corner[axis_] + leaf.edge) return;
    const Run right = run_of(leaf.corner[frame_.right] - frame_.low[frame_.right], leaf.edge, frame_.columns),
              up = run_of(leaf.corner[frame_.up] - frame_.low[frame_.up], leaf.edge, frame_.rows);
    const std::size_t state = rank(leaf.state);
    const std::size_t inside = static_cast<std::size_t>(right.voxels) * static_cast<std::size_t>(up.voxels);
    pixels_.counts[state] += inside;
    pixels_.counts.back() -= inside;
    pixels_.beyond[state] +=
        static_cast<std::size_t>(leaf.edge) * static_cast<std::size_t>(leaf.edge) - inside;
    if (inside > 0) draw(leaf.state, right, up);
  }

  /// Free is only what is so wholly, as far as the picture goes: nothing unknown may look free.
  SlicePixels take() {
    for (int row = 0; row < pixels_.height; ++row)
      for (int column = 0; column < pixels_.width; ++column) {
        const std::size_t at = place(column, row);
        if (ranks_[at] + 1U < slice_states.size()) continue;
        const double whole = covered(column, 0, frame_.columns, across_) *
                                 covered(pixels_.height - 1 - row, 0, frame_.rows, upward_) -
                             1e-6;
        if (known_[at] >= whole)
          ranks_[at] = static_cast<std::uint8_t>(
              rank(painted_[at] >= whole ? VoxelState::painted : VoxelState::seen_free));
      }
    pixels_.states.reserve(ranks_.size());
    for (const std::uint8_t each : ranks_) pixels_.states.push_back(slice_states[each]);
    return std::move(pixels_);
  }

 private:
  std::size_t place(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(pixels_.width) +
           static_cast<std::size_t>(column);
  }

  /// Voxels first ... first + voxels - 1 of a row or column of the picture.
  struct Run {
    int first, voxels;
  };
  static Run run_of(int first, int edge, int size) {
    const int low = std::max(first, 0);
    return {low, std::max(0, std::min(first + edge, size) - low)};
  }

  void draw(VoxelState state, const Run& right, const Run& up) {
    const auto [first_column, end_column] = pixels_of(right.first, right.voxels, across_, pixels_.width);
    const auto [first_row, end_row] = pixels_of(up.first, up.voxels, upward_, pixels_.height);
    const bool is_anywhere =
        shows_difference_ || state == VoxelState::occupied || state == VoxelState::conflict;
    for (int row = first_row; row < end_row; ++row)
      for (int column = first_column; column < end_column; ++column) {
        const std::size_t at = place(column, pixels_.height - 1 - row);
        if (is_anywhere) {
          ranks_[at] = std::min(ranks_[at], static_cast<std::uint8_t>(rank(state)));
          continue;
        }
        const double share =
            covered(column, right.first, right.voxels, across_) * covered(row, up.first, up.voxels, upward_);
        known_[at] += share;
        if (state == VoxelState::painted) painted_[at] += share;
      }
  }

  SliceFrame frame_;
  int axis_, layer_ = std::numeric_limits<int>::max();
  double across_, upward_;
  bool shows_difference_;
  SlicePixels pixels_;
  std::vector<std::uint8_t> ranks_;
  std::vector<double> painted_, known_;  // shares of each pixel that are painted, that are either
};

}  // namespace

SlicePixels slice_pixels(const MapLeaves& map, const SlicePlane& plane, double across, double upward,
                         bool shows_difference) {
  SliceRaster raster(map, plane, across, upward, shows_difference);
  map.visit([&](const MapLeaf& leaf) { raster.add(leaf); });
  return raster.take();
}

}  // namespace clearway
