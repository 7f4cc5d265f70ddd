#include "mapping/field/blocked_cells.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "mapping/system/parallel.hpp"
#include "mapping/voxels/fused_tree.hpp"

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

void BlockedCells::block_where_both(const BlockedCells& a, const BlockedCells& b) {
  for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= a.words_[i] & b.words_[i];
}

std::vector<CellBox> BlockedCells::differing(const BlockedCells& other) const {
  std::vector<CellBox> boxes;
  for (int lane = 0; lane < lanes_; ++lane) {
    for (int z = 0; z < size_.z(); ++z) {
      const std::uint32_t *here = row(lane, z), *there = other.row(lane, z);
      for (int y = 0; y < size_.y(); ++y) {
        const std::uint32_t bits = here[y] ^ there[y];
        if (bits == 0) continue;
        boxes.push_back({{32 * lane + std::countr_zero(bits), y, z},
                         {32 * lane + 32 - std::countl_zero(bits), y + 1, z + 1}});
      }
    }
  }
  return boxes;
}

std::size_t BlockedCells::count() const {
  std::size_t sum = 0;
  for (const std::uint32_t word : words_) sum += static_cast<std::size_t>(std::popcount(word));
  return sum;
}

std::ptrdiff_t BlockedCells::count_beyond(const BlockedCells& other) const {
  std::ptrdiff_t sum = 0;
  for (std::size_t i = 0; i < words_.size(); ++i) {
    if (words_[i] != other.words_[i]) sum += std::popcount(words_[i]) - std::popcount(other.words_[i]);
  }
  return sum;
}

namespace {

/// What a requirement forbids of a tree, in a block of cells. An inner node knows the highest log-odds below
/// it and the volumes that contain all of it, which often decides about the whole cube.
class TreeReader {
 public:
  /// @param low, high the cells (high exclusive) to fill in: threads may do different words.
  TreeReader(const FusedTree& tree, const Requirement& requirement, const Eigen::Vector3i& first,
             const Eigen::Vector3i& low, const Eigen::Vector3i& high, BlockedCells& cells)
      : tree_(tree),
        requirement_(requirement),
        unknown_blocked_(!allows(requirement, VoxelState::unknown, 0)),
        first_(first),
        low_(low),
        high_(high),
        cells_(cells) {}

  /// Fills in what is stored; the rest stays.
  void read() {
    const FusedNode* node = tree_.getRoot();
    CellCube cube;
    while (node != nullptr && node->has_children()) {  // down to where the cells are not all in one child
      const Eigen::Array3i middle = cube.corner.array() + cube.edge / 2 - first_.array();
      const auto beyond = low_.array() >= middle;
      if (!(beyond || high_.array() <= middle).all() || is_allowed(*node)) break;
      const unsigned child = (beyond[0] ? 1U : 0U) | (beyond[1] ? 2U : 0U) | (beyond[2] ? 4U : 0U);
      node = node->child(child);
      cube = cube.child(child);
    }
    read(node, cube, false);
  }

  /// Calls visit(box) for cubes that hold all that is forbidden, cut to the block; those of which only a part
  /// is are not wider than `narrow` cells.
  template <class Visit>
  void survey(const FusedNode* node, const CellCube& cube, bool inside, int narrow,
              const Visit& visit) const {
    if (!inside) {
      if (is_outside(cube)) return;
      inside = is_inside(cube);
    }
    if (is_allowed(node)) return;
    if (node == nullptr || !node->has_children() || cube.edge <= narrow) return visit(part_of(cube));
    for (unsigned i = 0; i < 8; ++i) __builtin_prefetch(node->child(i));
    for (unsigned i = 0; i < 8; ++i) survey(node->child(i), cube.child(i), inside, narrow, visit);
  }

  /// Fills in what differs between two versions of the tree.
  std::vector<CellBox> follow(const FusedNode* before, const FusedNode* now) {
    follow(before, now, CellCube{}, false);
    return std::move(filled_);
  }

 private:
  /// @param inside known to lie in the block, here and below.
  void read(const FusedNode* node, const CellCube& cube, bool inside) {
    if (node == nullptr) return;
    if (!inside) {
      if (is_outside(cube)) return;
      inside = is_inside(cube);
    }
    const bool allowed = is_allowed(*node);
    if (allowed || !node->has_children()) {
      if (allowed == unknown_blocked_) fill(cube, !allowed);
      return;
    }
    for (unsigned i = 0; i < 8; ++i) __builtin_prefetch(node->child(i));  // waiting for memory takes longest
    for (unsigned i = 0; i < 8; ++i) read(node->child(i), cube.child(i), inside);
  }

  void follow(const FusedNode* before, const FusedNode* now, const CellCube& cube, bool inside) {
    if (before == now) return;
    const bool was_allowed = is_allowed(before), allowed = is_allowed(now);
    if (was_allowed && allowed) return;
    if (!inside) {
      if (is_outside(cube)) return;
      inside = is_inside(cube);
    }
    const bool before_splits = before != nullptr && !was_allowed && before->has_children();
    const bool now_splits = now != nullptr && !allowed && now->has_children();
    if (!before_splits && !now_splits) {
      if (was_allowed != allowed) filled_.push_back(fill(cube, !allowed));
      return;
    }
    // Where one version is allowed as a whole it stands for each of its parts.
    std::array<const FusedNode*, 8> was{}, is{};
    for (unsigned i = 0; i < 8; ++i) {
      was[i] = before_splits ? before->child(i) : before;
      is[i] = now_splits ? now->child(i) : now;
      if (was[i] == is[i]) continue;
      __builtin_prefetch(was[i]);  // all at once: most of the time goes into waiting for memory
      __builtin_prefetch(is[i]);
    }
    for (unsigned i = 0; i < 8; ++i) {
      if (was[i] != is[i]) follow(was[i], is[i], cube.child(i), inside);
    }
  }

  bool is_outside(const CellCube& cube) const {
    const Eigen::Array3i corner = (cube.corner - first_).array();
    return (corner + cube.edge <= low_.array()).any() || (corner >= high_.array()).any();
  }
  bool is_inside(const CellCube& cube) const {
    const Eigen::Array3i corner = (cube.corner - first_).array();
    return (corner >= low_.array()).all() && (corner + cube.edge <= high_.array()).all();
  }
  bool is_allowed(const FusedNode* node) const {
    return node == nullptr ? !unknown_blocked_ : is_allowed(*node);
  }

  /// True when all of the cube is allowed; for an inner node false may mean "in part".
  bool is_allowed(const FusedNode& node) const {
    if (requirement_.policy == Policy::not_occupied) {  // what the lines below say, in short
      return !(node.observed() && tree_.isNodeOccupied(node));
    }
    const bool says_for_all = !node.has_children() || node.painted() != 0;
    return says_for_all && allows(requirement_, tree_.state(node), node.painted());
  }

  /// What of the cube lies in the block.
  CellBox part_of(const CellCube& cube) const {
    const Eigen::Vector3i corner = cube.corner - first_;
    return {corner.cwiseMax(low_), (corner.array() + cube.edge).matrix().cwiseMin(high_)};
  }

  /// @returns the part of the cube that lies in the block
  CellBox fill(const CellCube& cube, bool blocked) {
    const CellBox box = part_of(cube);
    const Eigen::Vector3i& corner = box.low;
    if (cube.edge == 1)
      cells_.set(corner.x(), corner.y(), corner.z(), blocked);
    else
      cells_.fill(box.low, box.high, blocked);
    return box;
  }

  const FusedTree& tree_;
  Requirement requirement_;
  bool unknown_blocked_;
  Eigen::Vector3i first_, low_, high_;
  BlockedCells& cells_;
  std::vector<CellBox> filled_;  ///< by follow()
};

/// Reads with so many threads, each a part of the lanes.
template <class Read>
void read_lanes(const FusedTree& tree, const Requirement& requirement, const Eigen::Vector3i& first,
                BlockedCells& cells, int threads, const Read& read) {
  const int parts = std::clamp(threads, 1, cells.lanes());
  parallel(static_cast<std::size_t>(parts), [&](std::size_t i) {
    const int part = static_cast<int>(i), lanes = cells.lanes();
    Eigen::Vector3i low = Eigen::Vector3i::Zero(), high = cells.size();
    low.x() = 32 * (part * lanes / parts);
    high.x() = std::min(32 * ((part + 1) * lanes / parts), high.x());
    TreeReader reader(tree, requirement, first, low, high, cells);
    read(reader, i);
  });
}

}  // namespace

BlockedCells blocked_cells(const FusedTree& tree, const Requirement& requirement,
                           const Eigen::Vector3i& first, const Eigen::Vector3i& size, int threads) {
  BlockedCells cells(size, !allows(requirement, VoxelState::unknown, 0));
  read_lanes(tree, requirement, first, cells, threads,
             [](TreeReader& reader, std::size_t) { reader.read(); });
  return cells;
}

void read_blocked_cells(const FusedTree& tree, const Requirement& requirement, const Eigen::Vector3i& first,
                        const Eigen::Vector3i& low, const Eigen::Vector3i& high, BlockedCells& cells) {
  cells.fill(low, high, !allows(requirement, VoxelState::unknown, 0));
  TreeReader(tree, requirement, first, low, high, cells).read();
}

void visit_blocked_boxes(const FusedTree& tree, const Requirement& requirement, const Eigen::Vector3i& first,
                         const Eigen::Vector3i& size, int narrow,
                         const std::function<void(const CellBox&)>& visit) {
  BlockedCells none(Eigen::Vector3i::Zero(), false);
  TreeReader(tree, requirement, first, Eigen::Vector3i::Zero(), size, none)
      .survey(tree.getRoot(), CellCube{}, false, narrow, visit);
}

std::vector<CellBox> follow_blocked_cells(const FusedTree& tree, const Requirement& requirement,
                                          const Eigen::Vector3i& first, const FusedTree& before,
                                          BlockedCells& cells, int threads) {
  std::vector<std::vector<CellBox>> of_parts(static_cast<std::size_t>(std::max(threads, 1)));
  read_lanes(tree, requirement, first, cells, threads, [&](TreeReader& reader, std::size_t part) {
    of_parts[part] = reader.follow(before.getRoot(), tree.getRoot());
  });
  std::vector<CellBox> changed = std::move(of_parts.front());
  for (std::size_t i = 1; i < of_parts.size(); ++i)
    changed.insert(changed.end(), of_parts[i].begin(), of_parts[i].end());
  return changed;
}

BlockedCells blocked_cells(const FusedTree& tree, const Requirement& requirement,
                           const Eigen::Vector3i& first, const FusedTree& before,
                           const BlockedCells& cells_before, int threads) {
  BlockedCells cells = cells_before;
  follow_blocked_cells(tree, requirement, first, before, cells, threads);
  return cells;
}

}  // namespace clearway
