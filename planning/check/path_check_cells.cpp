#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/check/path_check_model.hpp"

namespace clearway::check {
namespace {

constexpr double most_cells = 1e9;
constexpr double largest_cell = 2.1e9;  ///< far beyond what a map reaches, and still a whole number
constexpr int most_key = 32768;         ///< of a tree's cells, either way

/// True when the voxel of a point was not seen in the last seconds up to the map's newest look.
bool is_stale(const Snapshot& map, const Eigen::Vector3d& point, double seconds) {
  const auto seen = map.last_seen(point);
  return !seen || map.seen()->newest() - *seen > seconds;
}

/// Bits `begin` (0 to 63) to `end` (1 to 64) of a word.
std::uint64_t bits_between(int begin, int end) {
  const std::uint64_t all = ~std::uint64_t{0};
  return all >> (64 - end) & all << begin;
}

[[noreturn]] void refuse_far(double distance, double edge) {
  throw std::invalid_argument("the path leads the robot " + short_text(distance) +
                              " m from the map's origin, where no map reaches: expected at most " +
                              short_text(largest_cell * edge) + " m");
}

[[noreturn]] void refuse_large() {
  throw std::invalid_argument(
      "one edge of the path has more than 1e9 voxels about one body, expected a coarser map");
}

}  // namespace

BlockedCells::BlockedCells(const Snapshot& map, Policy policy, std::uint16_t volumes,
                           const Eigen::AlignedBox3d& box, double seen_within)
    : edge_(map.resolution()), outside_blocked_(policy != Policy::not_occupied) {
  const Eigen::Array3d across = box.sizes().array() / edge_ + 2.0;
  const double farthest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff()) / edge_;
  // Before they become whole numbers. Where no map reaches nothing is occupied, but all of it unknown.
  if (outside_blocked_ && !(farthest <= largest_cell)) refuse_far(farthest * edge_, edge_);
  if (!(across.prod() <= most_cells)) refuse_large();
  first_ = cell(box.min());
  size_ = cell(box.max()) - first_ + Eigen::Vector3i::Ones();
  words_ = (static_cast<std::size_t>(size_.x()) + 63) / 64;
  blocked_.assign(words_ * static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(size_.z()), 0);
  if (outside_blocked_) set(first_, first_ + size_, true);
  read(map, policy, volumes, seen_within);
  find_shell();
}

void BlockedCells::read(const Snapshot& map, Policy policy, std::uint16_t volumes, double seen_within) {
  const Eigen::AlignedBox3d block(first_.cast<double>() * edge_, (first_ + size_).cast<double>() * edge_);
  map.visit_leaves(block, [&](const Voxel& leaf) {
    const bool occupied = leaf.state == VoxelState::occupied || leaf.state == VoxelState::conflict;
    bool free = !occupied;
    if (policy == Policy::painted) free = free && (leaf.volumes & volumes) != 0;
    if (policy == Policy::known_free)
      free = leaf.state == VoxelState::painted || leaf.state == VoxelState::seen_free;
    const bool ages =
        policy == Policy::known_free && leaf.state == VoxelState::seen_free && seen_within > 0.0;
    if (!ages && free != outside_blocked_) return;  // as cells are where no leaf is
    // A pruned leaf is a cube of several voxels; its corners lie on cell borders.
    const Eigen::Array3d corner = (leaf.center.array() - leaf.size / 2) / edge_;
    const int across = static_cast<int>(leaf.size / edge_ + 0.5);
    const Eigen::Vector3i low = ((corner + (most_key + 0.5)).cast<int>() - most_key).matrix();  // rounded
    const Eigen::Vector3i begin = low.cwiseMax(first_);
    const Eigen::Vector3i end = (low.array() + across).matrix().cwiseMin(first_ + size_);
    if ((begin.array() >= end.array()).any()) return;
    if (!ages) return set(begin, end, !free);
    for (int z = begin.z(); z < end.z(); ++z) {
      for (int y = begin.y(); y < end.y(); ++y) {
        for (int x = begin.x(); x < end.x(); ++x) {
          const Eigen::Vector3i at(x, y, z);
          set(at, at + Eigen::Vector3i::Ones(), is_stale(map, center(at), seen_within));
        }
      }
    }
  });
}

void BlockedCells::set(const Eigen::Vector3i& begin, const Eigen::Vector3i& end, bool is_blocked) {
  const int from = begin.x() - first_.x(), to = end.x() - first_.x();
  for (int z = begin.z(); z < end.z(); ++z) {
    for (int y = begin.y(); y < end.y(); ++y) {
      std::uint64_t* const words = &blocked_[row(y - first_.y(), z - first_.z())];
      for (int word = from / 64; word <= (to - 1) / 64; ++word) {
        const std::uint64_t bits = bits_between(std::max(from - 64 * word, 0), std::min(to - 64 * word, 64));
        words[word] = is_blocked ? words[word] | bits : words[word] & ~bits;
      }
    }
  }
}

/// A cell is surrounded when all 27 cells about it are blocked: of three cells along x, of that along y, of
/// that along z. Cells beyond the block count as free, so that none is marked by guess.
BlockedCells::Bits BlockedCells::surrounded() const {
  Bits along_x(blocked_.size());
  for (std::size_t i = 0; i < blocked_.size(); ++i) {
    const std::size_t word = i % words_;
    const std::uint64_t before = word > 0 ? blocked_[i - 1] >> 63U : 0;
    const std::uint64_t after = word + 1 < words_ ? blocked_[i + 1] << 63U : 0;
    along_x[i] = blocked_[i] & (blocked_[i] << 1U | before) & (blocked_[i] >> 1U | after);
  }
  const auto of_three = [&](const Bits& bits, std::size_t stride, std::size_t length) {
    Bits least(bits.size(), 0);
    for (std::size_t i = 0; i < bits.size(); ++i) {
      const std::size_t along = i / stride % length;
      if (along > 0 && along + 1 < length) least[i] = bits[i - stride] & bits[i] & bits[i + stride];
    }
    return least;
  };
  const auto rows = static_cast<std::size_t>(size_.y()), layers = static_cast<std::size_t>(size_.z());
  return of_three(of_three(along_x, words_, rows), words_ * rows, layers);
}

void BlockedCells::find_shell() {
  shell_ = surrounded();
  for (std::size_t i = 0; i < shell_.size(); ++i) shell_[i] = blocked_[i] & ~shell_[i];
  blocks_ = (size_.array() + (block_edge - 1)) / block_edge;
  holds_shell_.reserve(block_index({0, 0, blocks_.z()}));
  for (int z = 0; z < size_.z(); z += block_edge) {
    for (int y = 0; y < size_.y(); y += block_edge) {
      std::uint64_t any = 0;  // of the rows of these blocks, in the word at hand
      for (int x = 0; x < size_.x(); x += block_edge) {
        if (x % 64 == 0) any = rows_together(shell_, x / 64, y, z);
        holds_shell_.push_back((any >> static_cast<unsigned>(x % 64) & block_bits) != 0);
      }
    }
  }
}

std::uint64_t BlockedCells::rows_together(const Bits& bits, int word, int y, int z) const {
  std::uint64_t any = 0;
  for (int k = z; k < std::min(z + block_edge, size_.z()); ++k) {
    for (int j = y; j < std::min(y + block_edge, size_.y()); ++j)
      any |= bits[row(j, k) + static_cast<std::size_t>(word)];
  }
  return any;
}

Eigen::Vector3i BlockedCells::cell(const Eigen::Vector3d& point) const {
  return (point.array() / edge_).floor().max(-largest_cell).min(largest_cell).cast<int>().matrix();
}

std::size_t BlockedCells::row(int y, int z) const {
  return words_ *
         (static_cast<std::size_t>(y) + static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(z));
}

bool BlockedCells::is_inside(const Eigen::Vector3i& at) const {
  return ((at - first_).array() >= 0).all() && ((at - first_).array() < size_.array()).all();
}

bool BlockedCells::is_blocked(const Eigen::Vector3i& at) const {
  if (!is_inside(at)) return outside_blocked_;
  const Eigen::Vector3i local = at - first_;
  const std::uint64_t word = blocked_[row(local.y(), local.z()) + static_cast<std::size_t>(local.x() / 64)];
  return (word >> static_cast<unsigned>(local.x() % 64) & 1U) != 0;
}

bool BlockedCells::blocks_touching(const Eigen::AlignedBox3d& box, Eigen::Vector3i& low,
                                   Eigen::Vector3i& high) const {
  const double touch = 1e-9;  // closed cells that touch the closed box belong to it
  const Eigen::Vector3i begin = cell(box.min().array() - touch * edge_ - 1e-12).cwiseMax(first_);
  const Eigen::Vector3i end =
      cell(box.max().array() + touch * edge_ + 1e-12).cwiseMin(first_ + size_ - Eigen::Vector3i::Ones());
  if ((begin.array() > end.array()).any()) return false;
  low = (begin - first_) / block_edge;
  high = (end - first_) / block_edge;
  return true;
}

std::size_t BlockedCells::block_index(const Eigen::Vector3i& block) const {
  const Eigen::Matrix<std::size_t, 3, 1> at = block.cast<std::size_t>();
  return at.x() +
         static_cast<std::size_t>(blocks_.x()) * (at.y() + static_cast<std::size_t>(blocks_.y()) * at.z());
}

}  // namespace clearway::check
