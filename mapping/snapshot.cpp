#include "mapping/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "mapping/field/field_cache.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/leaf_bounds.hpp"

namespace clearway {
namespace {

Voxel voxel_of(const FusedTree& tree, const FusedNode& node, const CellCube& cube) {
  Voxel voxel;
  voxel.state = tree.state(node);
  voxel.volumes = node.painted();
  voxel.observed = node.observed();
  voxel.log_odds = node.observed() ? static_cast<double>(node.getLogOdds()) : 0.0;
  voxel.center = (cube.corner.cast<double>().array() + 0.5 * cube.edge) * tree.getResolution();
  voxel.size = cube.edge * tree.getResolution();
  return voxel;
}

constexpr int least_cell = -32768, most_cell = 32767;  ///< of a tree, along each axis

void visit_cells(const FusedTree& tree, const Eigen::Vector3i& first, const Eigen::Vector3i& last,
                 const std::function<void(const Voxel&)>& visit) {
  tree.visit_leaves(first, last, [&](const FusedNode& node, const CellCube& cube) {
    const Voxel voxel = voxel_of(tree, node, cube);
    if (voxel.state != VoxelState::unknown) visit(voxel);
  });
}

}  // namespace

namespace {

/// The bounds of a tree's leaves, known when they were asked for, from those of the version before if it knew
/// its own.
class KnownBounds {
 public:
  KnownBounds() = default;
  explicit KnownBounds(const KnownBounds& previous, const std::shared_ptr<const FusedTree>& tree_before) {
    const std::lock_guard lock(previous.mutex_);
    if (previous.tree_ != tree_before) return;
    tree_ = previous.tree_;
    cells_ = previous.cells_;
  }

  Eigen::AlignedBox3i get(const std::shared_ptr<const FusedTree>& tree) {
    const std::lock_guard lock(mutex_);
    if (tree_ == tree) return cells_;
    cells_ = tree_ == nullptr ? leaf_bounds(*tree) : leaf_bounds(*tree, *tree_, cells_);
    tree_ = tree;
    return cells_;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const FusedTree> tree_;  ///< whose leaves these are: this version's, or the one before
  Eigen::AlignedBox3i cells_;
};

}  // namespace

struct Snapshot::State {
  State(std::shared_ptr<const FusedTree> stored, std::vector<PaintedVolume> painted,
        std::shared_ptr<const SeenStamps> stamps, const State* previous)
      : tree(std::move(stored)),
        seen(stamps != nullptr && stamps->empty() ? nullptr : std::move(stamps)),
        volumes(std::move(painted)),
        fields(tree, field_memory_limit, previous != nullptr ? &previous->fields : nullptr, seen),
        bounds(previous != nullptr ? KnownBounds(previous->bounds, previous->tree) : KnownBounds()) {}
  std::shared_ptr<const FusedTree> tree;
  std::shared_ptr<const SeenStamps> seen;
  std::vector<PaintedVolume> volumes;
  mutable FieldCache fields;
  mutable std::once_flag counted;
  mutable VoxelCounts counts;
  mutable KnownBounds bounds;
};

Snapshot::Snapshot() : Snapshot(std::make_shared<const FusedTree>(1.0), {}) {}

Snapshot::Snapshot(std::shared_ptr<const FusedTree> tree, std::vector<PaintedVolume> volumes,
                   std::shared_ptr<const SeenStamps> seen)
    : state_(std::make_shared<const State>(std::move(tree), std::move(volumes), std::move(seen), nullptr)) {}

Snapshot::Snapshot(std::shared_ptr<const FusedTree> tree, std::vector<PaintedVolume> volumes,
                   const Snapshot& previous, std::shared_ptr<const SeenStamps> seen)
    : state_(std::make_shared<const State>(std::move(tree), std::move(volumes), std::move(seen),
                                           previous.state_.get())) {}

double Snapshot::resolution() const { return state_->tree->getResolution(); }
const std::vector<PaintedVolume>& Snapshot::volumes() const { return state_->volumes; }
const FusedTree& Snapshot::tree() const { return *state_->tree; }
double Snapshot::log_odds_of_a_look() const { return -static_cast<double>(tree().getProbMissLog()); }

namespace {

VoxelCounts counts_of(const FusedTree& tree) {
  VoxelCounts counts;
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    switch (tree.state(node)) {
      case VoxelState::painted:
        counts.painted += cube.volume();
        break;
      case VoxelState::seen_free:
        counts.seen_free += cube.volume();
        break;
      case VoxelState::occupied:
        counts.occupied += cube.volume();
        break;
      case VoxelState::conflict:
        counts.conflict += cube.volume();
        break;
      case VoxelState::unknown:
        break;
    }
  });
  return counts;
}

bool any_leaf_is(const FusedTree& tree, const FusedNode& node, std::initializer_list<VoxelState> states) {
  if (!node.has_children()) return std::find(states.begin(), states.end(), tree.state(node)) != states.end();
  for (unsigned i = 0; i < 8; ++i) {
    const FusedNode* child = node.child(i);
    if (child != nullptr && any_leaf_is(tree, *child, states)) return true;
  }
  return false;
}

}  // namespace

VoxelCounts Snapshot::counts() const {
  std::call_once(state_->counted, [this] { state_->counts = counts_of(tree()); });
  return state_->counts;
}

bool Snapshot::holds_any(std::initializer_list<VoxelState> states) const {
  const FusedNode* root = tree().getRoot();
  return root != nullptr && any_leaf_is(tree(), *root, states);
}

Eigen::AlignedBox3d Snapshot::bounds() const {
  const Eigen::AlignedBox3i cells = state_->bounds.get(state_->tree);
  if (cells.isEmpty()) return {};
  return {cells.min().cast<double>() * resolution(), cells.max().cast<double>() * resolution()};
}

Voxel Snapshot::voxel(const Eigen::Vector3d& point) const {
  Voxel unknown;
  unknown.size = resolution();
  const auto cell = tree().cell(point);
  if (!cell) return unknown;
  CellCube cube;
  if (const FusedNode* node = tree().find_leaf(*cell, cube)) return voxel_of(tree(), *node, cube);
  unknown.center = (cell->cast<double>().array() + 0.5) * resolution();
  return unknown;
}

const SeenStamps* Snapshot::seen() const { return state_->seen.get(); }

std::optional<double> Snapshot::last_seen(const Eigen::Vector3d& point) const {
  const auto cell = tree().cell(point);
  return cell && seen() != nullptr ? seen()->last_seen(*cell) : std::nullopt;
}

void Snapshot::visit_leaves(const std::function<void(const Voxel&)>& visit) const {
  visit_cells(tree(), Eigen::Vector3i::Constant(least_cell), Eigen::Vector3i::Constant(most_cell), visit);
}

void Snapshot::visit_leaves(const Eigen::AlignedBox3d& box,
                            const std::function<void(const Voxel&)>& visit) const {
  if (box.isEmpty()) return;
  Eigen::Vector3i first, last;
  for (int axis = 0; axis < 3; ++axis) {  // a cell more on either side, whatever the division rounds
    const double low = std::floor(box.min()[axis] / resolution()) - 1.0;
    const double high = std::floor(box.max()[axis] / resolution()) + 1.0;
    if (low > most_cell || high < least_cell) return;
    first[axis] = low > least_cell ? static_cast<int>(low) : least_cell;
    last[axis] = high < most_cell ? static_cast<int>(high) : most_cell;
  }
  visit_cells(tree(), first, last, visit);
}

std::uint16_t Snapshot::volumes_of_part(const std::string& part) const {
  unsigned mask = 0;
  for (std::size_t i = 0; i < volumes().size(); ++i) {
    const auto& parts = volumes()[i].critical_parts;
    if (std::find(parts.begin(), parts.end(), part) != parts.end()) mask |= 1U << i;
  }
  return static_cast<std::uint16_t>(mask);
}

std::shared_ptr<const BlockedSpace> Snapshot::blocked_space(const Requirement& requirement,
                                                            const Eigen::AlignedBox3d& region,
                                                            double max_distance) const {
  return state_->fields.get(requirement, region, max_distance);
}

}  // namespace clearway
