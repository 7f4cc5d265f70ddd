#include "mapping/blocked_cells.hpp"

#include <algorithm>

#include "mapping/fused_tree.hpp"

namespace clearway {

BlockedCells::BlockedCells(const Eigen::Vector3i& size, bool blocked)
    : size_(size),
      lanes_((size.x() + 31) / 32),
      words_(static_cast<std::size_t>(lanes_) * static_cast<std::size_t>(size.y()) *
             static_cast<std::size_t>(size.z())) {
  if (blocked) fill(Eigen::Vector3i::Zero(), size, true);
}

unsigned BlockedCells::around(int x, int y, int z) const {
  const auto word = [&](int lane) { return lane < 0 || lane >= lanes_ ? 0U : row(lane, z)[y]; };
  const int lane = x >> 5;
  const unsigned bit = static_cast<unsigned>(x) & 31U;
  const std::uint32_t here = row(lane, z)[y];
  const unsigned before = bit > 0 ? here >> (bit - 1) : word(lane - 1) >> 31U;
  const unsigned after = bit < 31 ? here >> (bit + 1) : word(lane + 1);
  return (before & 1U) | (here >> bit & 1U) << 1U | (after & 1U) << 2U;
}

void BlockedCells::fill(const Eigen::Vector3i& low, const Eigen::Vector3i& high, bool blocked) {
  for (int lane = low.x() >> 5; lane << 5 < high.x(); ++lane) {
    const int first = std::max(low.x() - (lane << 5), 0);
    const int end = std::min(high.x() - (lane << 5), 32);
    const auto mask = static_cast<std::uint32_t>((std::uint64_t{1} << end) - (std::uint64_t{1} << first));
    for (int z = low.z(); z < high.z(); ++z) {
      std::uint32_t* words = &words_[index(lane, z)];
      for (int y = low.y(); y < high.y(); ++y) words[y] = blocked ? words[y] | mask : words[y] & ~mask;
    }
  }
}

std::size_t BlockedCells::count() const {
  std::size_t sum = 0;
  for (const std::uint32_t word : words_) sum += static_cast<std::size_t>(__builtin_popcount(word));
  return sum;
}

namespace {

/// The part of a cube of voxels that lies in a block, in cells of the block; empty when low >= high
/// somewhere.
struct Part {
  Part(const CellCube& cube, const Eigen::Vector3i& first, const Eigen::Vector3i& size)
      : low((cube.corner - first).cwiseMax(0)),
        high((cube.corner.array() + cube.edge - first.array()).matrix().cwiseMin(size)) {}
  bool is_empty() const { return (low.array() >= high.array()).any(); }

  Eigen::Vector3i low, high;
};

}  // namespace

BlockedCells blocked_cells(const FusedTree& tree, const Requirement& requirement,
                           const Eigen::Vector3i& first, const Eigen::Vector3i& size) {
  const bool unknown_blocked = !allows(requirement, VoxelState::unknown, 0);
  BlockedCells cells(size, unknown_blocked);
  const Eigen::Vector3i last = first + size - Eigen::Vector3i::Ones();
  tree.visit_leaves(first, last, [&](const FusedNode& node, const CellCube& cube) {
    const bool blocked = !allows(requirement, tree.state(node), node.painted());
    if (blocked == unknown_blocked) return;  // as it started
    const Part part(cube, first, size);
    cells.fill(part.low, part.high, blocked);
  });
  return cells;
}

BlockedCells blocked_cells(const FusedTree& tree, const Requirement& requirement,
                           const Eigen::Vector3i& first, const FusedTree& before,
                           const BlockedCells& cells_before) {
  const bool unknown_blocked = !allows(requirement, VoxelState::unknown, 0);
  const auto is_blocked = [&](const FusedNode* node) {
    return node == nullptr ? unknown_blocked : !allows(requirement, tree.state(*node), node->painted());
  };
  BlockedCells cells = cells_before;
  tree.visit_changes(before, [&](const FusedNode* was, const FusedNode* is, const CellCube& cube) {
    const bool blocked = is_blocked(is);
    if (blocked == is_blocked(was)) return;
    const Part part(cube, first, cells.size());
    if (!part.is_empty()) cells.fill(part.low, part.high, blocked);
  });
  return cells;
}

}  // namespace clearway
