#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/stamps/seen_stamps.hpp"
#include "planning/check/path_check_model.hpp"

namespace clearway::check {
namespace {

constexpr double most_cells = 1e9;
constexpr int block_edge = 8;  ///< cells

/// True when the voxel of a point was not seen in the last seconds up to the map's newest look.
bool is_stale(const Snapshot& map, const Eigen::Vector3d& point, double seconds) {
  const auto seen = map.last_seen(point);
  return !seen || map.seen()->newest() - *seen > seconds;
}

}  // namespace

BlockedCells::BlockedCells(const Snapshot& map, Policy policy, std::uint16_t volumes,
                           const Eigen::AlignedBox3d& box, double seen_within)
    : edge_(map.resolution()), outside_blocked_(policy != Policy::not_occupied) {
  first_ = cell(box.min());
  size_ = cell(box.max()) - first_ + Eigen::Vector3i::Ones();
  if (size_.cast<double>().prod() > most_cells) {
    throw std::invalid_argument("one edge of the path sweeps more than 1e9 voxels, expected a coarser map");
  }
  const auto count = static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                     static_cast<std::size_t>(size_.z());
  cells_.assign(count, outside_blocked_ ? blocked_cell : free_cell);
  map.visit_leaves([&](const Voxel& leaf) {
    const bool occupied = leaf.state == VoxelState::occupied || leaf.state == VoxelState::conflict;
    bool free = !occupied;
    if (policy == Policy::painted) free = free && (leaf.volumes & volumes) != 0;
    if (policy == Policy::known_free)
      free = leaf.state == VoxelState::painted || leaf.state == VoxelState::seen_free;
    const bool ages =
        policy == Policy::known_free && leaf.state == VoxelState::seen_free && seen_within > 0.0;
    // A pruned leaf is a cube of several voxels; its corners lie on cell borders.
    const Eigen::Array3d corner = (leaf.center.array() - leaf.size / 2) / edge_;
    const int across = static_cast<int>(std::lround(leaf.size / edge_));
    const Eigen::Vector3i low = corner.round().cast<int>().matrix();
    const Eigen::Vector3i begin = low.cwiseMax(first_);
    const Eigen::Vector3i end = (low.array() + across).matrix().cwiseMin(first_ + size_);
    for (int z = begin.z(); z < end.z(); ++z) {
      for (int y = begin.y(); y < end.y(); ++y) {
        for (int x = begin.x(); x < end.x(); ++x) {
          const bool is_free = free && !(ages && is_stale(map, center({x, y, z}), seen_within));
          cells_[index({x, y, z})] = is_free ? free_cell : blocked_cell;
        }
      }
    }
  });
  mark_surrounded();
  mark_blocks();
}

/// A cell is surrounded when all 27 cells about it are blocked: a minimum over three cells along x, of that
/// along y, of that along z. Cells beyond the block count as free, so that none is marked by guess.
void BlockedCells::mark_surrounded() {
  std::vector<std::uint8_t> least = cells_;
  const std::array<std::size_t, 3> stride{
      1, static_cast<std::size_t>(size_.x()),
      static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y())};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = least;
    const auto length = static_cast<std::size_t>(size_[static_cast<Eigen::Index>(axis)]);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const std::size_t along = i / stride[axis] % length;
      const bool border = along == 0 || along + 1 == length;
      least[i] = border ? std::uint8_t{free_cell}
                        : std::min({before[i - stride[axis]], before[i], before[i + stride[axis]]});
    }
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (least[i] == blocked_cell) cells_[i] = surrounded_cell;
  }
}

Eigen::Vector3i BlockedCells::cell(const Eigen::Vector3d& point) const {
  return (point.array() / edge_).floor().cast<int>().matrix();
}

bool BlockedCells::is_inside(const Eigen::Vector3i& at) const {
  return ((at - first_).array() >= 0).all() && ((at - first_).array() < size_.array()).all();
}

std::size_t BlockedCells::index(const Eigen::Vector3i& at) const {
  const Eigen::Matrix<std::size_t, 3, 1> local = (at - first_).cast<std::size_t>();
  return local.x() +
         static_cast<std::size_t>(size_.x()) * (local.y() + static_cast<std::size_t>(size_.y()) * local.z());
}

bool BlockedCells::is_blocked(const Eigen::Vector3i& at) const {
  return is_inside(at) ? cells_[index(at)] != free_cell : outside_blocked_;
}

std::vector<Eigen::Vector3i> BlockedCells::shell(const Eigen::AlignedBox3d& box) const {
  const double touch = 1e-9;  // closed cells that touch the closed box belong to it
  const Eigen::Vector3i begin = cell(box.min().array() - touch * edge_ - 1e-12).cwiseMax(first_);
  const Eigen::Vector3i end =
      cell(box.max().array() + touch * edge_ + 1e-12).cwiseMin(first_ + size_ - Eigen::Vector3i::Ones());
  std::vector<Eigen::Vector3i> found;
  if ((begin.array() > end.array()).any()) return found;
  const Eigen::Vector3i low = (begin - first_) / block_edge, high = (end - first_) / block_edge;
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const Eigen::Vector3i block(x, y, z);
        if (!block_has_shell_[block_index(block)]) continue;
        const Eigen::Vector3i corner = first_ + block * block_edge;
        append_shell(corner.cwiseMax(begin), (corner.array() + (block_edge - 1)).matrix().cwiseMin(end),
                     found);
      }
    }
  }
  return found;
}

void BlockedCells::append_shell(const Eigen::Vector3i& begin, const Eigen::Vector3i& end,
                                std::vector<Eigen::Vector3i>& found) const {
  for (int z = begin.z(); z <= end.z(); ++z) {
    for (int y = begin.y(); y <= end.y(); ++y) {
      for (int x = begin.x(); x <= end.x(); ++x) {
        if (cells_[index({x, y, z})] == blocked_cell) found.emplace_back(x, y, z);
      }
    }
  }
}

void BlockedCells::mark_blocks() {
  blocks_ = (size_.array() + (block_edge - 1)) / block_edge;
  block_has_shell_.assign(static_cast<std::size_t>(blocks_.prod()), false);
  std::size_t i = 0;
  for (int z = 0; z < size_.z(); ++z) {
    for (int y = 0; y < size_.y(); ++y) {
      for (int x = 0; x < size_.x(); ++x, ++i) {
        if (cells_[i] == blocked_cell)
          block_has_shell_[block_index(Eigen::Vector3i(x, y, z) / block_edge)] = true;
      }
    }
  }
}

std::size_t BlockedCells::block_index(const Eigen::Vector3i& block) const {
  const Eigen::Matrix<std::size_t, 3, 1> at = block.cast<std::size_t>();
  return at.x() +
         static_cast<std::size_t>(blocks_.x()) * (at.y() + static_cast<std::size_t>(blocks_.y()) * at.z());
}

}  // namespace clearway::check
