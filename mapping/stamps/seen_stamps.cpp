#include "mapping/stamps/seen_stamps.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/system/parallel.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t no_stamp = 65536;

std::uint64_t next_owner() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

bool holds(const Eigen::Vector3i& first, const Eigen::Vector3i& last, const Eigen::Vector3i& cell) {
  return (cell.array() >= first.array()).all() && (cell.array() <= last.array()).all();
}

Eigen::Vector3i tile_corner(const Eigen::Vector3i& cell) {
  return cell.unaryExpr([](int value) { return value & ~(SeenTile::edge - 1); });
}

}  // namespace

SeenStamps::SeenStamps() : table_(std::make_shared<Table>()), self_(next_owner()) { table_owner_ = self_; }

/// From now on neither of the two may write to what both hold.
SeenStamps::SeenStamps(const SeenStamps& other)
    : table_(other.table_),
      self_(next_owner()),
      exponent_(other.exponent_),
      base_(other.base_),
      newest_(other.newest_) {
  other.self_ = next_owner();
}

// ---- tiles

std::uint64_t SeenStamps::key_of(const Eigen::Vector3i& cell) {
  const auto coordinate = [&](int axis) { return static_cast<std::uint64_t>(cell[axis] + 32768) >> 5U; };
  return coordinate(0) | coordinate(1) << 11U | coordinate(2) << 22U;
}

Eigen::Vector3i SeenStamps::corner_of(std::uint64_t key) {
  const auto coordinate = [&](unsigned shift) { return static_cast<int>(key >> shift & 2047U) * 32 - 32768; };
  return {coordinate(0), coordinate(11), coordinate(22)};
}

const SeenTile* SeenStamps::find(const Eigen::Vector3i& cell) const {
  const std::uint64_t key = key_of(cell);
  const auto found =
      std::lower_bound(table_->begin(), table_->end(), key,
                       [](const Entry& entry, std::uint64_t value) { return entry.key < value; });
  return found != table_->end() && found->key == key ? found->tile.get() : nullptr;
}

SeenStamps::Table& SeenStamps::table_for_writing() {
  if (table_owner_ != self_) table_ = std::make_shared<Table>(*table_);
  table_owner_ = self_;
  return *table_;
}

/// Makes entries for the tiles that have none.
void SeenStamps::add_entries(std::vector<std::uint64_t> keys) {
  Table& table = table_for_writing();
  const auto by_key = [](const Entry& a, const Entry& b) { return a.key < b.key; };
  std::sort(keys.begin(), keys.end());
  Table added;
  auto known = table.begin();
  for (const std::uint64_t key : keys) {
    while (known != table.end() && known->key < key) ++known;
    if (known == table.end() || known->key != key) added.push_back({key, nullptr});
  }
  const auto middle = static_cast<std::ptrdiff_t>(table.size());
  table.insert(table.end(), added.begin(), added.end());
  std::inplace_merge(table.begin(), table.begin() + middle, table.end(), by_key);
}

SeenStamps::Entry& SeenStamps::entry(std::uint64_t key) {
  return *std::lower_bound(table_->begin(), table_->end(), key,
                           [](const Entry& each, std::uint64_t value) { return each.key < value; });
}

SeenTile& SeenStamps::tile_for_writing(Entry& entry, const Eigen::Vector3i& corner) {
  if (!entry.tile) {
    entry.tile = std::make_shared<SeenTile>(corner);
  } else if (entry.tile->owner != self_) {
    entry.tile = std::make_shared<SeenTile>(*entry.tile);
  }
  entry.tile->owner = self_;
  return *entry.tile;
}

// ---- time

double SeenStamps::period() const { return std::ldexp(1.0, exponent_); }

std::int64_t SeenStamps::index_of(double time) const {
  return static_cast<std::int64_t>(std::floor(std::ldexp(time, -exponent_)));
}

double SeenStamps::time_of(std::uint16_t stamp) const {
  return std::ldexp(static_cast<double>(base_ + stamp - 1), exponent_);
}

std::uint32_t SeenStamps::least_stamp(double since) const {
  const double stamp = std::ceil(std::ldexp(since, -exponent_)) - static_cast<double>(base_) + 1.0;
  return stamp > static_cast<double>(most_periods) ? no_stamp
                                                   : static_cast<std::uint32_t>(std::max(stamp, 1.0));
}

/// Lets stamps span a period with this number, too.
void SeenStamps::make_room(std::int64_t index) {
  constexpr std::int64_t early = 1024;  // periods: scans of several sensors come in any order
  if (!newest_) {
    base_ = index;
    return;
  }
  const std::int64_t low = std::min(base_, index), high = std::max(index_of(*newest_), index);
  int coarser = 0;
  while ((high >> coarser) - (low >> coarser) >= most_periods) ++coarser;
  if (coarser == 0 && low == base_) return;
  const std::int64_t room = most_periods - 1 - ((high >> coarser) - (low >> coarser));
  rebase(coarser, (low >> coarser) - (low < base_ ? std::min(early, room) : 0));
}

/// Makes periods 2^coarser times as long and lets stamps count from another one.
void SeenStamps::rebase(int coarser, std::int64_t base) {
  const auto again = [&](std::uint16_t stamp) {
    return static_cast<std::uint16_t>(((base_ + stamp - 1) >> coarser) - base + 1);
  };
  if (coarser != 0 || base != base_) {
    for (Entry& each : table_for_writing()) {
      if (each.tile) tile_for_writing(each, each.tile->corner()).replace(again);
    }
  }
  exponent_ += coarser;
  base_ = base;
}

// ---- looking

void SeenStamps::see(ScanGrid& grid, double time, int threads) {
  if (!(std::abs(time) <= latest_time)) return;
  make_room(index_of(time));
  const auto stamp = static_cast<std::uint16_t>(index_of(time) - base_ + 1);
  newest_ = std::max(newest_.value_or(time), time);

  const std::vector<ScanTile*> scan = grid.tiles();
  std::vector<std::uint64_t> keys;
  for (const ScanTile* tile : scan) keys.push_back(key_of(tile->corner));
  add_entries(std::move(keys));
  const auto workers = static_cast<std::size_t>(threads);
  parallel(workers, [&](std::size_t worker) {
    for (std::size_t i = worker; i < scan.size(); i += workers)
      tile_for_writing(entry(key_of(scan[i]->corner)), scan[i]->corner).raise(*scan[i], stamp);
  });
}

std::optional<double> SeenStamps::last_seen(const Eigen::Vector3i& cell) const {
  const SeenTile* tile = find(cell);
  const std::uint16_t stamp = tile == nullptr ? std::uint16_t{0} : tile->at(ScanTile::bit_of(cell));
  return stamp == 0 ? std::nullopt : std::optional(time_of(stamp));
}

namespace {

/// Calls `visit(cube)` for the cells of a tile inside first..last that have at least this stamp.
template <class Visit>
void visit_tile(const SeenTile& tile, std::uint32_t least, const Eigen::Vector3i& first,
                const Eigen::Vector3i& last, const Visit& visit) {
  constexpr int block_edge = 8;
  for (unsigned block = 0; block < SeenTile::blocks; ++block) {
    const SeenTile::Block* cells = tile.mixed(block);
    if (cells == nullptr && tile.uniform(block) < least) continue;
    const Eigen::Vector3i low = tile.corner() + ScanTile::local_of(block << 9U);
    const Eigen::Vector3i high = low.array() + (block_edge - 1);
    if ((low.array() > last.array()).any() || (high.array() < first.array()).any()) continue;
    const bool is_inside = holds(first, last, low) && holds(first, last, high);
    if (cells == nullptr && is_inside) {
      visit(CellCube{low, block_edge});
      continue;
    }
    for (unsigned i = 0; i < SeenTile::block_cells; ++i) {
      if ((cells == nullptr ? tile.uniform(block) : (*cells)[i]) < least) continue;
      const Eigen::Vector3i cell = tile.corner() + ScanTile::local_of(block << 9U | i);
      if (is_inside || holds(first, last, cell)) visit(CellCube{cell, 1});
    }
  }
}

}  // namespace

void SeenStamps::visit_since(double since, const Eigen::Vector3i& first, const Eigen::Vector3i& last,
                             const std::function<void(const CellCube&)>& visit) const {
  const std::uint32_t least = least_stamp(since);
  if (least == no_stamp || (first.array() > last.array()).any()) return;
  const Eigen::Vector3i low = tile_corner(first), high = tile_corner(last);
  const Eigen::Array3d across = (high - low).cast<double>().array() / SeenTile::edge + 1.0;
  if (across.prod() > static_cast<double>(table_->size())) {  // most of them have no tile
    for (const Entry& each : *table_) {
      if (each.tile && holds(low, high, each.tile->corner()))
        visit_tile(*each.tile, least, first, last, visit);
    }
    return;
  }
  for (int z = low.z(); z <= high.z(); z += SeenTile::edge) {
    for (int y = low.y(); y <= high.y(); y += SeenTile::edge) {
      for (int x = low.x(); x <= high.x(); x += SeenTile::edge) {
        if (const SeenTile* tile = find({x, y, z})) visit_tile(*tile, least, first, last, visit);
      }
    }
  }
}

double SeenStamps::oldest() const {
  std::uint32_t least = no_stamp;
  for (const Entry& each : *table_) {
    for (unsigned bit = 0; each.tile && bit < SeenTile::blocks * SeenTile::block_cells; ++bit) {
      const std::uint32_t stamp = each.tile->at(bit);
      if (stamp != 0) least = std::min(least, stamp);
    }
  }
  return least == no_stamp ? newest() : time_of(static_cast<std::uint16_t>(least));
}

std::size_t SeenStamps::voxels() const {
  std::size_t count = 0;
  for (const Entry& each : *table_) {
    for (unsigned bit = 0; each.tile && bit < SeenTile::blocks * SeenTile::block_cells; ++bit)
      count += each.tile->at(bit) != 0 ? 1U : 0U;
  }
  return count;
}

std::size_t SeenStamps::bytes() const {
  std::size_t bytes = sizeof(SeenStamps) + table_->size() * sizeof(Entry);
  for (const Entry& each : *table_) bytes += each.tile ? each.tile->bytes() : 0;
  return bytes;
}

}  // namespace clearway
