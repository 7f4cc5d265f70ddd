#include "mapping/field/distance_tiles.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <type_traits>
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

}  // namespace

/// What neighbouring tiles need again: distances along z, and within planes of y and z. It may be forgotten.
struct DistanceTiles::Memory {
  static constexpr std::size_t most = 4096;  ///< tiles of each kind
  explicit Memory(std::size_t tiles) : steps(tiles), planes(tiles) {}

  struct FreeSlot {
    void operator()(Tile* tile) const { TilePool::free(tile); }
  };
  using OwnTile = std::unique_ptr<Tile, FreeSlot>;
  static OwnTile make() {
    static_assert(std::is_trivially_destructible_v<Tile>);
    return OwnTile(new (TilePool::allocate()) Tile);  // its cells are not set
  }

  /// The squared distances along z; a line is useful, by its bit, where one is below the cap.
  struct Squares {
    OwnTile cells;
    std::uint64_t useful = 0;
  };

  void forget() {
    for (Squares& squares : steps) squares = {};
    for (OwnTile& plane : planes) plane = nullptr;
    kept = 0;
  }

  std::vector<Squares> steps;
  std::vector<OwnTile> planes;
  std::size_t kept = 0;

  // What one tile needs, kept for the next.
  std::vector<std::uint32_t> words;
  std::vector<std::uint8_t> counted, useful;
  std::vector<std::uint16_t> squares, row;
  std::vector<int> nearest;
  std::vector<const Squares*> around;
  std::vector<const Tile*> lanes;
};

/// Computes tiles, one axis after the other: z by counting, then y, then x by the least sum.
class DistanceTiles::Maker {
 public:
  explicit Maker(const DistanceTiles& tiles)
      : tiles_(tiles), axes_(tiles.axes_), memory_(*tiles.memory_), size_(tiles.size()) {}

  std::shared_ptr<const Tile> made(const Eigen::Vector3i& at) {
    if (!may_hold(at, within_reach)) return tiles_.nothing_;
    if (holds_all(at)) return tiles_.all_;
    const int around = (axes_.margin() + nx - 1) / nx, lanes = 2 * around + 1;
    std::vector<const Tile*>& planes = memory_.lanes;
    planes.assign(static_cast<std::size_t>(lanes), nullptr);
    for (int lane = -tiles_.reach_.x(); lane <= tiles_.reach_.x(); ++lane)
      planes[static_cast<std::size_t>(around + lane)] = plane(at + Eigen::Vector3i(lane, 0, 0));
    const auto tile = std::allocate_shared<Tile>(TileAllocator<Tile>());
    std::vector<std::uint16_t>& row = memory_.row;
    row.assign(static_cast<std::size_t>(lanes * nx), axes_.cap());
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

  /// Whether cells of the tiles so near to one may be blocked.
  bool may_hold(const Eigen::Vector3i& at, std::uint8_t where) const {
    return is_inside(at) && (tiles_.near_[index(at)] & where) != 0;
  }

  bool holds_all(const Eigen::Vector3i& at) const {
    if (!may_hold(at, here)) return false;
    tiles_.read_under_lock(index(at));
    std::uint32_t all = ~0U;
    const Box box = tiles_.box_of(at);
    for (int z = box.low.z(); z < box.high.z(); ++z) {
      const std::uint32_t* row = tiles_.blocked_.row(at.x(), z);
      for (int y = box.low.y(); y < box.high.y(); ++y) all &= row[y];
    }
    return all == ~0U;
  }

  /// The squared distances along z; null: at the cap everywhere.
  const Memory::Squares* steps(const Eigen::Vector3i& at) {
    if (!may_hold(at, along_z)) return nullptr;
    Memory::Squares& known = memory_.steps[index(at)];
    if (known.cells) return &known;
    for (int z = -tiles_.reach_.z(); z <= tiles_.reach_.z(); ++z) {
      const Eigen::Vector3i beside = at + Eigen::Vector3i(0, 0, z);
      if (may_hold(beside, here)) tiles_.read_under_lock(index(beside));
    }
    const Box box = tiles_.box_of(at);
    const int first = std::max(box.low.z() - axes_.window(), 0);
    const int end = std::min(box.high.z() + axes_.window(), size_.z());
    std::vector<std::uint32_t>& words = memory_.words;
    words.assign(static_cast<std::size_t>((end - first) * ny), 0);
    for (int z = first; z < end; ++z) {
      const std::uint32_t* row = tiles_.blocked_.row(at.x(), z);
      std::copy(row + box.low.y(), row + box.high.y(), &words[static_cast<std::size_t>((z - first) * ny)]);
    }
    std::vector<std::uint8_t>& counted = memory_.counted;
    counted.resize(words.size() * nx);
    axes_.count_steps(words.data(), ny, end - first, counted.data());
    known.cells = Memory::make();
    ++memory_.kept;
    const std::size_t lines = static_cast<std::size_t>(box.high.z() - box.low.z()) * ny;
    static_assert(ny * nz == 64);
    for (std::size_t line = 0; line < lines; ++line) {
      const std::size_t from = static_cast<std::size_t>((box.low.z() - first) * line_cells) + line * nx;
      const bool is_useful = axes_.square_steps(&counted[from], &(*known.cells)[line * nx]);
      known.useful |= std::uint64_t{is_useful} << line;
    }
    // 0 above the block: no change there is near enough to reach.
    std::fill(known.cells->begin() + static_cast<std::ptrdiff_t>(lines * nx), known.cells->end(), 0);
    return &known;
  }

  /// The squared distances within the planes of y and z; null: at the cap everywhere.
  const Tile* plane(const Eigen::Vector3i& at) {
    if (!may_hold(at, in_plane)) return nullptr;
    Memory::OwnTile& known = memory_.planes[index(at)];
    if (known) return known.get();
    memory_.around.clear();
    for (int y = -tiles_.reach_.y(); y <= tiles_.reach_.y(); ++y)
      memory_.around.push_back(steps(at + Eigen::Vector3i(0, y, 0)));
    known = Memory::make();
    ++memory_.kept;
    memory_.squares.assign(static_cast<std::size_t>((ny + 2 * axes_.margin()) * nx), axes_.cap());
    for (int z = 0; z < nz; ++z) plane_line(z, &(*known)[static_cast<std::size_t>(z * line_cells)]);
    return known.get();
  }

  /// All lines of a tile at one z: y by the least sum of the squared steps along z, which the tiles `around`
  /// have, along y. Without them `squares` stay at the cap.
  void plane_line(int z, std::uint16_t* out) {
    const int window = axes_.window(), reach = tiles_.reach_.y();
    std::vector<std::uint8_t>& useful = memory_.useful;
    useful.assign(static_cast<std::size_t>(ny + 2 * window), 0);
    memory_.nearest.resize(useful.size());
    std::uint16_t* squares = &memory_.squares[static_cast<std::size_t>(axes_.margin() * nx)];
    for (int along = -reach; along <= reach; ++along) {
      const Memory::Squares* tile = memory_.around[static_cast<std::size_t>(along + reach)];
      if (tile == nullptr) continue;
      const int first = along * ny, low = std::max(first, -window), high = std::min(first + ny, ny + window);
      const std::uint16_t* from =
          &(*tile->cells)[static_cast<std::size_t>(z * line_cells + (low - first) * nx)];
      std::copy(from, from + (high - low) * nx, squares + low * nx);
      for (int y = low; y < high; ++y)
        useful[static_cast<std::size_t>(y + window)] = tile->useful >> (z * ny + y - first) & 1U;
    }
    find_nearest(useful, window + 1, memory_.nearest);
    for (int y = 0; y < ny; ++y)
      axes_.lower(squares + y * nx, nx, memory_.nearest[static_cast<std::size_t>(y + window)], out + y * nx);
  }

  const DistanceTiles& tiles_;
  const DistanceAxes& axes_;
  Memory& memory_;
  Eigen::Vector3i size_;
};

DistanceTiles::DistanceTiles(BlockedCells blocked, std::uint16_t cap)
    : axes_(cap), blocked_(std::move(blocked)) {
  allocate();
  for (std::size_t i = 0; i < tiles_.size(); ++i) is_read_[i] = true;
}

DistanceTiles::DistanceTiles(const Eigen::Vector3i& size, std::uint16_t cap, ReadCells read,
                             VisitBlocked visit)
    : axes_(cap), blocked_(size, false), read_(std::move(read)), visit_blocked_(std::move(visit)) {
  allocate();
}

DistanceTiles::DistanceTiles(const DistanceTiles& before, const FollowCells& follow, ReadCells read,
                             VisitBlocked visit)
    : axes_(before.axes_),
      blocked_(before.size(), false),
      read_(std::move(read)),
      visit_blocked_(std::move(visit)),
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
  if (near_.empty()) look_near();
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

/// Of each tile, whether cells of it may be blocked, and cells of tiles that matter to it, axis after axis.
/// Where none are, they are known.
void DistanceTiles::look_near() const {
  near_.assign(tiles_.size(), read_ && !visit_blocked_ ? here : 0);
  const auto mark = [&](const Box& box) {
    const Eigen::Array3i edges(nx, ny, nz);
    const Eigen::Array3i low = box.low.array() / edges, high = (box.high.array() - 1) / edges;
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y)
        std::fill_n(&near_[tile(low.x(), y * ny, z * nz)], high.x() - low.x() + 1, here);
    }
  };
  if (visit_blocked_) visit_blocked_(mark);
  for (std::size_t i = 0; i < near_.size(); ++i) {
    if (!read_ && any_blocked(box_of(place(i)))) near_[i] = here;
    if (near_[i] == 0) is_read_[i].store(true, std::memory_order_release);
  }
  spread(2, here, along_z);
  spread(1, along_z, in_plane);
  spread(0, in_plane, within_reach);
}

bool DistanceTiles::any_blocked(const Box& box) const {
  std::uint32_t any = 0;
  for (int z = box.low.z(); z < box.high.z(); ++z) {
    const std::uint32_t* row = blocked_.row(box.low.x() / nx, z);
    for (int y = box.low.y(); y < box.high.y(); ++y) any |= row[y];
  }
  return any != 0;
}

/// Gives `to` to the tiles that have `from`, and to those in reach of them along an axis: two sweeps count
/// the steps.
void DistanceTiles::spread(int axis, std::uint8_t from, std::uint8_t to) const {
  const auto stride = static_cast<std::size_t>(counts_.head(axis).prod());
  const auto length = stride * static_cast<std::size_t>(counts_[axis]);  // of all lines side by side
  const auto far = static_cast<std::uint8_t>(reach_[axis] + 1);
  std::vector<std::uint8_t> steps(near_.size());
  const auto one_more = [far](std::uint8_t count) {
    return static_cast<std::uint8_t>(std::min(count + 1, int{far}));
  };
  for (std::size_t first = 0; first < steps.size(); first += length) {
    for (std::size_t i = first; i < first + length; ++i) {
      const std::uint8_t before = i < first + stride ? far : one_more(steps[i - stride]);
      steps[i] = (near_[i] & from) != 0 ? std::uint8_t{0} : before;
    }
    for (std::size_t i = first + length; i-- > first;) {
      if (i + stride < first + length) steps[i] = std::min(steps[i], one_more(steps[i + stride]));
      if (steps[i] < far) near_[i] |= to;
    }
  }
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
