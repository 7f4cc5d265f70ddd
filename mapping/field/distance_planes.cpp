#include "mapping/field/distance_planes.hpp"

#include <algorithm>
#include <cstring>

namespace clearway {
namespace {

/// Steps from each line to the nearest other line that is useful; `far` where there is none.
void find_nearest(const std::vector<std::uint8_t>& useful, int far, std::vector<int>& nearest) {
  const auto count = static_cast<int>(useful.size());
  int last = -far;
  for (int i = 0; i < count; ++i) {
    nearest[static_cast<std::size_t>(i)] = i - last;
    if (useful[static_cast<std::size_t>(i)] != 0) last = i;
  }
  last = count + far;
  for (int i = count - 1; i >= 0; --i) {
    int& steps = nearest[static_cast<std::size_t>(i)];
    steps = std::min({steps, last - i, far});
    if (useful[static_cast<std::size_t>(i)] != 0) last = i;
  }
}

constexpr LineChange whole_line{0, 0, lane_cells - 1};

}  // namespace

PlaneUpdate::PlaneUpdate(DistanceChange& change)
    : change_(change),
      axes_(change.axes),
      ny_(change.after.size().y()),
      nz_(change.after.size().z()),
      steps_(static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nz_) * lane_cells),
      squares_(static_cast<std::size_t>(ny_ + 2 * axes_.margin()) * lane_cells, axes_.cap()),
      least_(static_cast<std::size_t>(ny_ + lane_cells + 2 * axes_.margin()), axes_.cap()),
      reach_(static_cast<std::size_t>(ny_ + lane_cells)),
      useful_(static_cast<std::size_t>(ny_)),
      nearest_(static_cast<std::size_t>(ny_)) {
  if (change.uniform) {
    uniform_line_.assign(lane_cells, *change.uniform ? 0 : static_cast<std::uint8_t>(axes_.window() + 1));
  }
}

void PlaneUpdate::lane(TiledCells& planes, int lane) {
  if (!find_columns(lane)) return;
  axes_.count_steps(change_.after.row(lane, 0), ny_, nz_, steps_.data());
  if (!change_.uniform) count_old_steps(lane);
  for (int z = 0; z < nz_; ++z) plane_line(planes, lane, z);
}

/// The columns (along z) of a lane in which a bit changed.
bool PlaneUpdate::find_columns(int lane) {
  const int cells = std::min(change_.after.size().x() - lane * lane_cells, lane_cells);
  const std::uint32_t all_alike = change_.uniform.value_or(false) ? ~0U >> (lane_cells - cells) : 0;
  std::vector<std::uint32_t> difference(static_cast<std::size_t>(ny_));
  for (int z = 0; z < nz_; ++z) {
    const std::uint32_t* was = change_.before.row(lane, z);
    const std::uint32_t* is = change_.after.row(lane, z);
    for (int y = 0; y < ny_; ++y) {
      difference[static_cast<std::size_t>(y)] |= (change_.uniform ? all_alike : was[y]) ^ is[y];
    }
  }
  columns_.clear();
  for (int y = 0; y < ny_; ++y) {
    if (difference[static_cast<std::size_t>(y)] != 0) columns_.push_back(y);
  }
  return !columns_.empty();
}

void PlaneUpdate::count_old_steps(int lane) {
  std::vector<std::uint32_t> words;
  words.reserve(columns_.size() * static_cast<std::size_t>(nz_));
  for (int z = 0; z < nz_; ++z) {
    for (const int y : columns_) words.push_back(change_.before.row(lane, z)[y]);
  }
  old_steps_.resize(words.size() * lane_cells);
  axes_.count_steps(words.data(), static_cast<int>(columns_.size()), nz_, old_steps_.data());
}

/// All cells of a lane at one z: y by the least sum of the steps along z. A cell can only change where the
/// sum from a changed one, before or after, is no more than what it holds.
void PlaneUpdate::plane_line(TiledCells& planes, int lane, int z) {
  if (!find_reach(z)) return;
  int first = ny_, last = 0;
  for (int y = 0; y < ny_; ++y) {
    __builtin_prefetch(planes.line(lane, std::min(y + TiledCells::ny, ny_ - 1), z));
    std::uint16_t& reach = reach_[static_cast<std::size_t>(y)];
    if (reach < axes_.cap() && axes_.any_at_least(planes.line(lane, y, z), reach)) {
      first = std::min(first, y);
      last = y;
    } else {
      reach = axes_.cap();
    }
  }
  std::uint16_t* squares = &squares_[static_cast<std::size_t>(axes_.margin()) * lane_cells];
  for (int y = std::max(first - axes_.window(), 0); y <= std::min(last + axes_.window(), ny_ - 1); ++y) {
    const bool useful = axes_.square_steps(steps(y, z), squares + y * lane_cells);
    useful_[static_cast<std::size_t>(y)] = useful ? 1 : 0;
  }
  find_nearest(useful_, axes_.window() + 1, nearest_);
  alignas(64) std::uint16_t line[lane_cells];
  for (int y = first; y <= last; ++y) {
    if (reach_[static_cast<std::size_t>(y)] == axes_.cap()) continue;
    axes_.lower(squares + y * lane_cells, lane_cells, nearest_[static_cast<std::size_t>(y)], line);
    const std::uint16_t* before = planes.line(lane, y, z);
    if (std::memcmp(before, line, sizeof line) == 0) continue;
    change_.row(y, z)[lane] = !change_.uniform ? line_change(before, line) : whole_line;
    planes.write(lane, y, z, line);
  }
}

/// The least sum from a changed cell at this z, for each y. Returns false when nothing changed.
bool PlaneUpdate::find_reach(int z) {
  std::uint16_t* least = &least_[static_cast<std::size_t>(axes_.margin())];
  std::fill_n(least, ny_, axes_.cap());
  bool any = false;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::uint8_t* before = old_steps(i, z);
    const std::uint8_t* after = steps(columns_[i], z);
    if (std::memcmp(before, after, lane_cells) == 0) continue;
    const int count = !change_.uniform ? least_changed(before, after) : 0;
    least[columns_[i]] = static_cast<std::uint16_t>(gap_squared(count));
    any = true;
  }
  if (!any) return false;
  for (int y = 0; y < ny_; y += lane_cells) {
    axes_.lower(least + y, 1, 1, &reach_[static_cast<std::size_t>(y)]);
  }
  return true;
}

}  // namespace clearway
