#include "mapping/distance_layers.hpp"

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

}  // namespace

/// One change of bits, carried through the three axes: z by counting, then y, then x.
class DistanceLayers::Update {
 public:
  /// @param uniform what all cells were before, when they were all alike.
  Update(BlockedCells before, std::optional<bool> uniform, const BlockedCells& after, std::uint16_t cap)
      : before_(std::move(before)),
        after_(after),
        axes_(cap),
        ny_(after.size().y()),
        nz_(after.size().z()),
        steps_(static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nz_) * lane_cells),
        changes_(static_cast<std::size_t>(after.lanes()) * static_cast<std::size_t>(ny_) *
                 static_cast<std::size_t>(nz_)),
        squares_(static_cast<std::size_t>(ny_ + 2 * axes_.margin()) * lane_cells, cap),
        least_(static_cast<std::size_t>(ny_ + lane_cells + 2 * axes_.margin()), cap),
        reach_(static_cast<std::size_t>(ny_ + lane_cells)),
        useful_(static_cast<std::size_t>(ny_)),
        nearest_(static_cast<std::size_t>(ny_)) {
    if (uniform)
      uniform_line_.assign(lane_cells, *uniform ? 0 : static_cast<std::uint8_t>(axes_.window() + 1));
  }

  void planes(TiledCells& planes) {
    for (int lane = 0; lane < after_.lanes(); ++lane) {
      if (!find_columns(lane)) continue;
      axes_.count_steps(after_.row(lane, 0), ny_, nz_, steps_.data());
      if (uniform_line_.empty()) count_old_steps(lane);
      for (int z = 0; z < nz_; ++z) plane_line(planes, lane, z);
    }
  }

  void rows(const TiledCells& planes, TiledCells& distances) {
    std::vector<std::uint16_t> row(static_cast<std::size_t>(after_.lanes() * lane_cells + 2 * axes_.margin()),
                                   axes_.cap());
    for (int tz = 0; tz < nz_; tz += TiledCells::nz) {
      for (int ty = 0; ty < ny_; ty += TiledCells::ny) {
        for (int z = tz; z < std::min(tz + TiledCells::nz, nz_); ++z) {
          for (int y = ty; y < std::min(ty + TiledCells::ny, ny_); ++y) one_row(planes, distances, y, z, row);
        }
      }
    }
  }

 private:
  static constexpr LineChange whole_line{0, 0, lane_cells - 1};

  /// The columns (along z) of a lane in which a bit changed.
  bool find_columns(int lane) {
    std::vector<std::uint32_t> difference(static_cast<std::size_t>(ny_));
    for (int z = 0; z < nz_; ++z) {
      const std::uint32_t* was = before_.row(lane, z);
      const std::uint32_t* is = after_.row(lane, z);
      for (int y = 0; y < ny_; ++y) difference[static_cast<std::size_t>(y)] |= was[y] ^ is[y];
    }
    columns_.clear();
    for (int y = 0; y < ny_; ++y) {
      if (difference[static_cast<std::size_t>(y)] != 0) columns_.push_back(y);
    }
    return !columns_.empty();
  }

  void count_old_steps(int lane) {
    std::vector<std::uint32_t> words;
    words.reserve(columns_.size() * static_cast<std::size_t>(nz_));
    for (int z = 0; z < nz_; ++z) {
      for (const int y : columns_) words.push_back(before_.row(lane, z)[y]);
    }
    old_steps_.resize(words.size() * lane_cells);
    axes_.count_steps(words.data(), static_cast<int>(columns_.size()), nz_, old_steps_.data());
  }

  const std::uint8_t* steps(int y, int z) const {
    return &steps_[static_cast<std::size_t>(z * ny_ + y) * lane_cells];
  }
  const std::uint8_t* old_steps(std::size_t column, int z) const {
    if (!uniform_line_.empty()) return uniform_line_.data();
    return &old_steps_[(static_cast<std::size_t>(z) * columns_.size() + column) * lane_cells];
  }

  /// All cells of a lane at one z: y by the least sum of the steps along z. A cell can only change where the
  /// sum from a changed one, before or after, is no more than what it holds.
  void plane_line(TiledCells& planes, int lane, int z) {
    if (!find_reach(z)) return;
    int first = ny_, last = 0;
    for (int y = 0; y < ny_; ++y) {
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
      changes(y, z)[lane] = uniform_line_.empty() ? line_change(before, line) : whole_line;
      planes.write(lane, y, z, line);
    }
  }

  /// The least sum from a changed cell at this z, for each y. Returns false when nothing changed.
  bool find_reach(int z) {
    std::uint16_t* least = &least_[static_cast<std::size_t>(axes_.margin())];
    std::fill_n(least, ny_, axes_.cap());
    bool any = false;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const std::uint8_t* before = old_steps(i, z);
      const std::uint8_t* after = steps(columns_[i], z);
      if (std::memcmp(before, after, lane_cells) == 0) continue;
      const int count = uniform_line_.empty() ? least_changed(before, after) : 0;
      least[columns_[i]] = static_cast<std::uint16_t>(gap_squared(count));
      any = true;
    }
    if (!any) return false;
    for (int y = 0; y < ny_; y += lane_cells) {
      axes_.lower(least + y, 1, 1, &reach_[static_cast<std::size_t>(y)]);
    }
    return true;
  }

  LineChange* changes(int y, int z) {
    return &changes_[(static_cast<std::size_t>(z) * static_cast<std::size_t>(ny_) +
                      static_cast<std::size_t>(y)) *
                     static_cast<std::size_t>(after_.lanes())];
  }

  /// One row of cells along x by the least sum of the distances in the planes.
  void one_row(const TiledCells& planes, TiledCells& distances, int y, int z,
               std::vector<std::uint16_t>& row) {
    const int lanes = after_.lanes();
    const LineChange* change = changes(y, z);
    if (std::none_of(change, change + lanes, [](const LineChange& line) { return line.any(); })) return;
    std::uint16_t* cells = &row[static_cast<std::size_t>(axes_.margin())];
    for (int lane = 0; lane < lanes; ++lane) {
      std::memcpy(cells + lane * lane_cells, planes.line(lane, y, z), lane_cells * sizeof(std::uint16_t));
    }
    std::fill(cells + after_.size().x(), cells + lanes * lane_cells, axes_.cap());
    alignas(64) std::uint16_t line[lane_cells];
    for (int lane = 0; lane < lanes; ++lane) {
      const int reach = reach_of_row(change, lane);
      if (reach >= axes_.cap()) continue;
      if (!axes_.any_at_least(distances.line(lane, y, z), static_cast<std::uint16_t>(reach))) continue;
      axes_.lower(cells + lane * lane_cells, 1, 1, line);
      distances.write(lane, y, z, line);
    }
  }

  /// The least sum from a changed cell of the row to any of the 32 of a lane.
  int reach_of_row(const LineChange* change, int lane) const {
    const int far = (axes_.window() + lane_cells - 1) / lane_cells;
    int reach = axes_.cap();
    for (int from = std::max(lane - far, 0); from <= std::min(lane + far, after_.lanes() - 1); ++from) {
      if (!change[from].any()) continue;
      int steps = 0;
      if (from < lane) steps = (lane - from) * lane_cells - change[from].last;
      if (from > lane) steps = (from - lane - 1) * lane_cells + change[from].first + 1;
      reach = std::min(reach, change[from].least + gap_squared(steps));
    }
    return reach;
  }

  const BlockedCells before_;
  const BlockedCells& after_;
  DistanceAxes axes_;
  int ny_, nz_;
  std::vector<std::uint8_t> uniform_line_;       ///< steps of a line before, when all cells were alike
  std::vector<int> columns_;                     ///< of the lane, y
  std::vector<std::uint8_t> steps_, old_steps_;  ///< of the lane along z; the old ones of its columns only
  std::vector<LineChange> changes_;              ///< by z, y, lane: of the distances in the planes
  std::vector<std::uint16_t> squares_;           ///< of the lane at one z
  std::vector<std::uint16_t> least_, reach_;     ///< at one z, by y
  std::vector<std::uint8_t> useful_;
  std::vector<int> nearest_;
};

DistanceLayers::DistanceLayers(BlockedCells blocked, std::uint16_t cap, bool keep_planes)
    : cap_(cap), blocked_(std::move(blocked)), distances_(blocked_.size(), cap) {
  // From all cells alike, as most of them are: what stays so takes no work and no memory.
  const bool start =
      2 * blocked_.count() > static_cast<std::size_t>(blocked_.size().cast<std::int64_t>().prod());
  Update update(BlockedCells(blocked_.size(), start), start, blocked_, cap);
  TiledCells planes(blocked_.size(), start ? 0 : cap);
  if (start) distances_ = TiledCells(blocked_.size(), 0);
  update.planes(planes);
  if (keep_planes) {
    update.rows(planes, distances_);
    planes_.emplace(std::move(planes));
  } else {
    distances_ = std::move(planes);
    update.rows(distances_, distances_);  // a row is read as a whole before it is written
  }
}

DistanceLayers::DistanceLayers(const DistanceLayers& before, BlockedCells blocked)
    : cap_(before.cap_),
      blocked_(std::move(blocked)),
      planes_(before.planes_),
      distances_(before.distances_) {
  Update update(before.blocked_, std::nullopt, blocked_, cap_);
  update.planes(*planes_);
  update.rows(*planes_, distances_);
}

std::size_t DistanceLayers::bytes() const {
  const std::size_t tiles = distances_.distinct_tiles() + (planes_ ? planes_->distinct_tiles() : 0);
  return blocked_.bytes() + tiles * TiledCells::tile_bytes;
}

}  // namespace clearway
