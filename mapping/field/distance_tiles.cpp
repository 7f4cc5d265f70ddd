#include "mapping/field/distance_tiles.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "mapping/field/tile_pool.hpp"

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

std::size_t count_of(const Eigen::Vector3i& counts) { return counts.cast<std::size_t>().prod(); }

/// The least squared distance, in half voxels, from cells of one box to cells of the other.
int least_between(const CellBox& a, const CellBox& b) {
  const Eigen::Array3i steps = (b.low - a.high).cwiseMax(a.low - b.high).array() + 1;
  int sum = 0;
  for (const int along : steps) sum += gap_squared(std::max(along, 0));
  return sum;
}

}  // namespace

/// What neighbouring tiles need again: distances along z, and within planes of y and z. It may be forgotten.
struct DistanceTiles::Memory {
  static constexpr std::size_t most = 4096;  ///< tiles of each kind
  explicit Memory(std::size_t tiles) : holds(tiles, Holds::not_known), steps(tiles), planes(tiles) {}

  void forget() {
    std::fill(steps.begin(), steps.end(), nullptr);
    std::fill(planes.begin(), planes.end(), nullptr);
    kept = 0;
  }

  std::vector<Holds> holds;  ///< of each tile
  std::vector<std::unique_ptr<Steps>> steps;
  std::vector<std::unique_ptr<Tile>> planes;
  std::size_t kept = 0;
};

/// Computes tiles, one axis after the other: z by counting, then y, then x by the least sum.
class DistanceTiles::Maker {
 public:
  explicit Maker(const DistanceTiles& tiles)
      : tiles_(tiles), axes_(tiles.axes_), memory_(*tiles.memory_), size_(tiles.size()) {}

  std::shared_ptr<const Tile> made(const Eigen::Vector3i& at) {
    if (!any_holds(at, tiles_.reach_)) return tiles_.nothing_;
    if (holds(at) == Holds::all) return tiles_.all_;
    const int around = (axes_.margin() + nx - 1) / nx, lanes = 2 * around + 1;
    std::vector<const Tile*> planes(static_cast<std::size_t>(lanes), nullptr);
    for (int lane = -tiles_.reach_.x(); lane <= tiles_.reach_.x(); ++lane)
      planes[static_cast<std::size_t>(around + lane)] = plane(at + Eigen::Vector3i(lane, 0, 0));
    const auto tile = std::allocate_shared<Tile>(TileAllocator<Tile>());
    std::vector<std::uint16_t> row(static_cast<std::size_t>(lanes * nx), axes_.cap());
    for (std::size_t cell = 0; cell < tile_cells; cell += nx) {
      for (std::size_t i = 0; i < planes.size(); ++i) {
        if (planes[i] != nullptr) std::memcpy(&row[i * nx], &(*planes[i])[cell], nx * sizeof(std::uint16_t));
      }
      axes_.lower(&row[static_cast<std::size_t>(around * nx)], 1, 1, &(*tile)[cell]);
    }
    return tile;
  }

 private:
  static constexpr int line_cells = ny * nx;  ///< at one z of a tile

  bool is_inside(const Eigen::Vector3i& at) const {
    return (at.array() >= 0).all() && (at.array() < tiles_.counts_.array()).all();
  }
  std::size_t index(const Eigen::Vector3i& at) const { return tiles_.tile(at.x(), at.y() * ny, at.z() * nz); }

  /// Whether cells of a tile are blocked.
  Holds holds(const Eigen::Vector3i& at) const {
    if (!is_inside(at)) return Holds::nothing;
    const std::size_t i = index(at);
    if (memory_.holds[i] != Holds::not_known) return memory_.holds[i];
    tiles_.read_under_lock(i);
    std::uint32_t any = 0, all = ~0U;
    const Box box = tiles_.box_of(at);
    for (int z = box.low.z(); z < box.high.z(); ++z) {
      const std::uint32_t* row = tiles_.blocked_.row(at.x(), z);
      for (int y = box.low.y(); y < box.high.y(); ++y) {
        any |= row[y];
        all &= row[y];
      }
    }
    return memory_.holds[i] = any == 0 ? Holds::nothing : all == ~0U ? Holds::all : Holds::something;
  }

  /// Whether cells of a tile, or so many tiles beside it, are blocked. Afterwards all of these are read.
  bool any_holds(const Eigen::Vector3i& at, const Eigen::Vector3i& reach) const {
    bool any = false;
    for (int z = -reach.z(); z <= reach.z(); ++z) {
      for (int y = -reach.y(); y <= reach.y(); ++y) {
        for (int x = -reach.x(); x <= reach.x(); ++x)
          any |= holds(at + Eigen::Vector3i(x, y, z)) != Holds::nothing;
      }
    }
    return any;
  }

  /// How many steps along z the nearest blocked cell is away; null: too many everywhere.
  const Steps* steps(const Eigen::Vector3i& at) {
    const int reach = tiles_.reach_.z();
    if (!is_inside(at) || !any_holds(at, {0, 0, reach})) return nullptr;
    std::unique_ptr<Steps>& known = memory_.steps[index(at)];
    if (known) return known.get();
    const Box box = tiles_.box_of(at);
    const int first = std::max(box.low.z() - axes_.window(), 0);
    const int end = std::min(box.high.z() + axes_.window(), size_.z());
    std::vector<std::uint32_t> words(static_cast<std::size_t>((end - first) * ny), 0);
    for (int z = first; z < end; ++z) {
      const std::uint32_t* row = tiles_.blocked_.row(at.x(), z);
      std::copy(row + box.low.y(), row + box.high.y(), &words[static_cast<std::size_t>((z - first) * ny)]);
    }
    counted_.resize(words.size() * nx);
    axes_.count_steps(words.data(), ny, end - first, counted_.data());
    known = std::make_unique<Steps>();  // 0 above the block: no change there is near enough to reach
    ++memory_.kept;
    std::copy_n(&counted_[static_cast<std::size_t>((box.low.z() - first) * line_cells)],
                (box.high.z() - box.low.z()) * line_cells, known->begin());
    return known.get();
  }

  /// The squared distances within the planes of y and z; null: at the cap everywhere.
  const Tile* plane(const Eigen::Vector3i& at) {
    const int reach = tiles_.reach_.y();
    if (!is_inside(at) || !any_holds(at, {0, reach, tiles_.reach_.z()})) return nullptr;
    std::unique_ptr<Tile>& known = memory_.planes[index(at)];
    if (known) return known.get();
    std::vector<const Steps*> around;
    for (int y = -reach; y <= reach; ++y) around.push_back(steps(at + Eigen::Vector3i(0, y, 0)));
    known = std::make_unique<Tile>();
    ++memory_.kept;
    squares_.assign(static_cast<std::size_t>((ny + 2 * axes_.margin()) * nx), axes_.cap());
    for (int z = 0; z < nz; ++z) plane_line(around, z, &(*known)[static_cast<std::size_t>(z * line_cells)]);
    return known.get();
  }

  /// All lines of a tile at one z: y by the least sum of the squared steps along z.
  /// @param around steps of the tiles before, of and after it along y; without them squares_ stay at the cap
  void plane_line(const std::vector<const Steps*>& around, int z, std::uint16_t* out) {
    const int window = axes_.window(), count = ny + 2 * window;
    useful_.assign(static_cast<std::size_t>(count), 0);
    nearest_.resize(static_cast<std::size_t>(count));
    std::uint16_t* squares = &squares_[static_cast<std::size_t>(axes_.margin() * nx)];
    for (int y = -window; y < ny + window; ++y) {
      const int from_first = y + tiles_.reach_.y() * ny;
      const Steps* counted = around[static_cast<std::size_t>(from_first / ny)];
      if (counted == nullptr) continue;
      const std::uint8_t* line = &(*counted)[static_cast<std::size_t>(z * line_cells + from_first % ny * nx)];
      useful_[static_cast<std::size_t>(y + window)] = axes_.square_steps(line, squares + y * nx) ? 1 : 0;
    }
    find_nearest(useful_, window + 1, nearest_);
    for (int y = 0; y < ny; ++y)
      axes_.lower(squares + y * nx, nx, nearest_[static_cast<std::size_t>(y + window)], out + y * nx);
  }

  const DistanceTiles& tiles_;
  const DistanceAxes& axes_;
  Memory& memory_;
  Eigen::Vector3i size_;
  std::vector<std::uint8_t> counted_, useful_;
  std::vector<std::uint16_t> squares_;
  std::vector<int> nearest_;
};

DistanceTiles::DistanceTiles(BlockedCells blocked, std::uint16_t cap)
    : axes_(cap), blocked_(std::move(blocked)) {
  allocate();
  for (std::size_t i = 0; i < tiles_.size(); ++i) is_read_[i] = true;
}

DistanceTiles::DistanceTiles(const Eigen::Vector3i& size, std::uint16_t cap, ReadCells read)
    : axes_(cap), blocked_(size, false), read_(std::move(read)) {
  allocate();
}

DistanceTiles::DistanceTiles(const DistanceTiles& before, const FollowCells& follow, ReadCells read)
    : axes_(before.axes_),
      blocked_(before.size(), false),
      read_(std::move(read)),
      nothing_(before.nothing_),
      all_(before.all_) {
  allocate();
  {
    const std::lock_guard lock(before.computing_);  // others go on reading cells into those of `before`
    blocked_ = before.blocked_;
    tiles_ = before.tiles_;
    for (std::size_t i = 0; i < tiles_.size(); ++i) is_read_[i] = before.is_read_[i].load();
  }
  share(before, follow(blocked_));
}

DistanceTiles::DistanceTiles(const DistanceTiles& before, BlockedCells blocked)
    : DistanceTiles(before,
                    [&](BlockedCells& cells) {
                      std::vector<Box> changes = blocked.differing(cells);
                      cells = std::move(blocked);
                      return changes;
                    },
                    {}) {}

DistanceTiles::~DistanceTiles() = default;

void DistanceTiles::allocate() {
  const Eigen::Array3i edges(nx, ny, nz);
  counts_ = (size().array() + edges - 1) / edges;
  reach_ = ((axes_.window() + edges - 1) / edges).matrix();
  const std::size_t count = count_of(counts_);
  known_ = std::make_unique<std::atomic<const std::uint16_t*>[]>(count);
  is_read_ = std::make_unique<std::atomic<bool>[]>(count);
  tiles_.resize(count);
  if (nothing_ != nullptr) return;
  const auto uniform = [](std::uint16_t value) {
    const auto tile = std::allocate_shared<Tile>(TileAllocator<Tile>());
    tile->fill(value);
    return tile;
  };
  nothing_ = uniform(axes_.cap());
  all_ = uniform(0);
}

/// Keeps the tiles that no change reaches.
void DistanceTiles::share(const DistanceTiles& before, const std::vector<Box>& changes) {
  std::vector<bool> is_outdated = reached_by_changes(changes);
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    if (tiles_[i] == nullptr) {
      is_outdated[i] = false;
    } else if (is_outdated[i]) {
      tiles_[i] = nullptr;
    } else {
      known_[i] = tiles_[i]->data();
    }
  }
  for (const std::size_t i : before.outdated_) is_outdated[i] = tiles_[i] == nullptr;
  for (std::size_t i = 0; i < tiles_.size(); ++i)
    if (is_outdated[i]) outdated_.push_back(i);
}

/// Whether a number of a known tile is at least so much.
bool DistanceTiles::any_at_least(std::size_t tile, int distance) const {
  const Tile& cells = *tiles_[tile];
  for (std::size_t cell = 0; cell < tile_cells; cell += nx)
    if (axes_.any_at_least(&cells[cell], static_cast<std::uint16_t>(distance))) return true;
  return false;
}

/// The known tiles whose distances a changed cell can have changed: where a distance is at least that to the
/// change. Smaller ones end at another cell, before and after.
std::vector<bool> DistanceTiles::reached_by_changes(const std::vector<Box>& changes) const {
  std::vector<bool> reached(tiles_.size(), false);
  std::vector<int> at_most(tiles_.size(), cap() - 1);  // what is known of each tile: the cap is no distance
  for (const auto& [changed, cells] : changes_in_tiles(changes)) {
    if (!is_read_[changed]) continue;
    const Eigen::Vector3i low = (place(changed) - reach_).cwiseMax(0);
    const Eigen::Vector3i high = (place(changed) + reach_).cwiseMin(counts_ - Eigen::Vector3i::Ones());
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          const std::size_t i = tile(x, y * ny, z * nz);
          if (tiles_[i] == nullptr || reached[i]) continue;
          const int between = least_between(box_of({x, y, z}), cells);
          if (between > at_most[i]) continue;
          reached[i] = any_at_least(i, between);
          if (!reached[i]) at_most[i] = between - 1;
        }
      }
    }
  }
  return reached;
}

/// The tiles that hold cells of the boxes, and of each a box about these cells.
std::vector<std::pair<std::size_t, DistanceTiles::Box>> DistanceTiles::changes_in_tiles(
    const std::vector<Box>& changes) const {
  constexpr int none = -1;
  std::vector<std::pair<std::size_t, Box>> in_tiles;
  std::vector<int> number(tiles_.size(), none);  // of each tile in `in_tiles`
  for (const Box& change : changes) {
    for (int z = change.low.z() / nz; z * nz < change.high.z(); ++z) {
      for (int y = change.low.y() / ny; y * ny < change.high.y(); ++y) {
        for (int x = change.low.x() / nx; x * nx < change.high.x(); ++x) {
          const std::size_t i = tile(x, y * ny, z * nz);
          const Box here = box_of({x, y, z});
          if (number[i] == none) {
            number[i] = static_cast<int>(in_tiles.size());
            in_tiles.emplace_back(i, Box{here.high, here.low});
          }
          Box& cells = in_tiles[static_cast<std::size_t>(number[i])].second;
          cells.low = cells.low.cwiseMin(change.low.cwiseMax(here.low));
          cells.high = cells.high.cwiseMax(change.high.cwiseMin(here.high));
        }
      }
    }
  }
  return in_tiles;
}

Eigen::Vector3i DistanceTiles::place(std::size_t tile) const {
  const auto index = static_cast<int>(tile);
  return {index % counts_.x(), index / counts_.x() % counts_.y(), index / counts_.x() / counts_.y()};
}

DistanceTiles::Box DistanceTiles::box_of(const Eigen::Vector3i& place) const {
  const Eigen::Vector3i edges(nx, ny, nz), low = place.cwiseProduct(edges);
  return {low, (low + edges).cwiseMin(size())};
}

const std::uint16_t* DistanceTiles::computed(std::size_t tile) const {
  const std::lock_guard lock(computing_);
  if (tiles_[tile] != nullptr) return tiles_[tile]->data();  // another thread was quicker
  if (memory_ == nullptr) memory_ = std::make_unique<Memory>(tiles_.size());
  if (memory_->kept > Memory::most) memory_->forget();
  tiles_[tile] = Maker(*this).made(place(tile));
  known_[tile].store(tiles_[tile]->data(), std::memory_order_release);
  return tiles_[tile]->data();
}

void DistanceTiles::read_cells(std::size_t tile) const {
  const std::lock_guard lock(computing_);
  read_under_lock(tile);
}

void DistanceTiles::read_under_lock(std::size_t tile) const {
  if (is_read_[tile].load(std::memory_order_relaxed)) return;
  read_(box_of(place(tile)), blocked_);
  is_read_[tile].store(true, std::memory_order_release);
}

const BlockedCells& DistanceTiles::blocked_in(const Eigen::Vector3i& low, const Eigen::Vector3i& high) const {
  const Eigen::Array3i edges(nx, ny, nz);
  const Eigen::Array3i first = low.array().max(0) / edges;
  const Eigen::Array3i last = high.array().min(size().array() - 1) / edges;
  if ((high.array() < 0).any()) return blocked_;
  for (int z = first.z(); z <= last.z(); ++z) {
    for (int y = first.y(); y <= last.y(); ++y) {
      for (int x = first.x(); x <= last.x(); ++x) {
        const std::size_t i = tile(x, y * ny, z * nz);
        if (!is_read_[i].load(std::memory_order_acquire)) read_cells(i);
      }
    }
  }
  return blocked_;
}

const BlockedCells& DistanceTiles::blocked() const {
  if (!all_read_.load(std::memory_order_acquire)) {
    blocked_in(Eigen::Vector3i::Zero(), size());
    all_read_.store(true, std::memory_order_release);
  }
  return blocked_;
}

void DistanceTiles::renew() const {
  for (const std::size_t i : outdated_) {
    if (known_[i].load(std::memory_order_acquire) == nullptr) computed(i);
  }
}

void DistanceTiles::complete() const {
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    if (known_[i].load(std::memory_order_acquire) == nullptr) computed(i);
  }
}

std::size_t DistanceTiles::known() const {
  const std::lock_guard lock(computing_);
  return static_cast<std::size_t>(
      std::count_if(tiles_.begin(), tiles_.end(), [](const auto& tile) { return tile != nullptr; }));
}

std::size_t DistanceTiles::bytes() const {
  const std::lock_guard lock(computing_);
  const auto own = std::count_if(tiles_.begin(), tiles_.end(), [&](const auto& tile) {
    return tile != nullptr && tile != nothing_ && tile != all_;
  });
  const std::size_t kept = memory_ == nullptr ? 0 : memory_->kept;
  return blocked_.bytes() + (static_cast<std::size_t>(own) + kept) * sizeof(Tile);
}

}  // namespace clearway
