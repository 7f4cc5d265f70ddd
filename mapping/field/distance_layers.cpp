#include "mapping/field/distance_layers.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "mapping/field/distance_planes.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {
namespace {

/// Carries a change through the third axis. Holds what one thread needs for it.
class RowUpdate {
 public:
  explicit RowUpdate(DistanceChange& change)
      : change_(change),
        axes_(change.axes),
        row_(static_cast<std::size_t>(change.after.lanes() * lane_cells + 2 * axes_.margin()), axes_.cap()) {}

  /// The rows along x of the tiles at one z; `planes` may be `distances`, for a row is read as a whole before
  /// it is written.
  void slab(const TiledCells& planes, TiledCells& distances, int tile_z) {
    const int ny = change_.after.size().y();
    const int first = tile_z * TiledCells::nz,
              end = std::min(first + TiledCells::nz, change_.after.size().z());
    for (int tile_y = 0; tile_y < ny; tile_y += TiledCells::ny) {
      for (int z = first; z < end; ++z) {
        for (int y = tile_y; y < std::min(tile_y + TiledCells::ny, ny); ++y) one_row(planes, distances, y, z);
      }
    }
  }

 private:
  /// One row of cells along x by the least sum of the distances in the planes.
  void one_row(const TiledCells& planes, TiledCells& distances, int y, int z) {
    const int lanes = change_.after.lanes();
    const LineChange* change = change_.row(y, z);
    if (std::none_of(change, change + lanes, [](const LineChange& line) { return line.any(); })) return;
    std::uint16_t* cells = &row_[static_cast<std::size_t>(axes_.margin())];
    for (int lane = 0; lane < lanes; ++lane) {
      __builtin_prefetch(distances.line(lane, y, z));
      std::memcpy(cells + lane * lane_cells, planes.line(lane, y, z), lane_cells * sizeof(std::uint16_t));
    }
    std::fill(cells + change_.after.size().x(), cells + lanes * lane_cells, axes_.cap());
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
    for (int from = std::max(lane - far, 0); from <= std::min(lane + far, change_.after.lanes() - 1);
         ++from) {
      if (!change[from].any()) continue;
      int steps = 0;
      if (from < lane) steps = (lane - from) * lane_cells - change[from].last;
      if (from > lane) steps = (from - lane - 1) * lane_cells + change[from].first + 1;
      reach = std::min(reach, change[from].least + gap_squared(steps));
    }
    return reach;
  }

  DistanceChange& change_;
  const DistanceAxes& axes_;
  std::vector<std::uint16_t> row_;
};

/// Calls `worker(i)` once for each i below `count`, on several threads, each with a worker of its own.
template <class Make>
void share(int count, int threads, const Make& make) {
  std::atomic<int> next = 0;
  parallel(static_cast<std::size_t>(std::min(threads, count)), [&](std::size_t) {
    auto worker = make();
    for (int i = next++; i < count; i = next++) worker(i);
  });
}

/// z and y: lanes of x lie in different tiles.
void update_planes(DistanceChange& change, TiledCells& planes, int threads) {
  share(change.after.lanes(), threads, [&] {
    return [&planes, update = PlaneUpdate(change)](int lane) mutable { update.lane(planes, lane); };
  });
}

/// x: so do tiles at different z.
void update_rows(DistanceChange& change, const TiledCells& planes, TiledCells& distances, int threads) {
  share(distances.tile_counts().z(), threads, [&] {
    return [&planes, &distances, update = RowUpdate(change)](int z) mutable {
      update.slab(planes, distances, z);
    };
  });
}

}  // namespace

DistanceLayers::DistanceLayers(BlockedCells blocked, std::uint16_t cap, bool keep_planes, int threads)
    : cap_(cap), blocked_(std::move(blocked)), distances_(blocked_.size(), cap) {
  // From all cells alike, as most of them are: what stays so takes no work and no memory.
  const bool start =
      2 * blocked_.count() > static_cast<std::size_t>(blocked_.size().cast<std::int64_t>().prod());
  DistanceChange change(blocked_, start, blocked_, cap);
  TiledCells planes(blocked_.size(), start ? 0 : cap);
  if (start) distances_ = TiledCells(blocked_.size(), 0);
  update_planes(change, planes, threads);
  if (keep_planes) {
    update_rows(change, planes, distances_, threads);
    planes_.emplace(std::move(planes));
  } else {
    distances_ = std::move(planes);
    update_rows(change, distances_, distances_, threads);
  }
}

DistanceLayers::DistanceLayers(const DistanceLayers& before, BlockedCells blocked, int threads)
    : cap_(before.cap_),
      blocked_(std::move(blocked)),
      planes_(before.planes_),
      distances_(before.distances_) {
  DistanceChange change(before.blocked_, std::nullopt, blocked_, cap_);
  update_planes(change, *planes_, threads);
  update_rows(change, *planes_, distances_, threads);
}

std::size_t DistanceLayers::bytes() const {
  const std::size_t tiles = distances_.distinct_tiles() + (planes_ ? planes_->distinct_tiles() : 0);
  return blocked_.bytes() + tiles * TiledCells::tile_bytes;
}

}  // namespace clearway
