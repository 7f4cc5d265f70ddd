#include "mapping/snapshot.hpp"

#include <algorithm>
#include <limits>
#include <mutex>
#include <utility>

#include "mapping/field/field_cache.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

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

}  // namespace

struct Snapshot::State {
  State(std::shared_ptr<const FusedTree> stored, std::vector<PaintedVolume> painted,
        std::shared_ptr<const SeenStamps> stamps, FieldCache* previous)
      : tree(std::move(stored)),
        seen(stamps != nullptr && stamps->empty() ? nullptr : std::move(stamps)),
        volumes(std::move(painted)),
        fields(tree, field_memory_limit, previous, seen) {}
  std::shared_ptr<const FusedTree> tree;
  std::shared_ptr<const SeenStamps> seen;
  std::vector<PaintedVolume> volumes;
  mutable FieldCache fields;
  mutable std::once_flag counted;
  mutable VoxelCounts counts;
  mutable std::once_flag bounds_known;
  mutable Eigen::AlignedBox3i bounds;  ///< of all leaves, in cells
};

Snapshot::Snapshot() : Snapshot(std::make_shared<const FusedTree>(1.0), {}) {}

Snapshot::Snapshot(std::shared_ptr<const FusedTree> tree, std::vector<PaintedVolume> volumes,
                   std::shared_ptr<const SeenStamps> seen)
    : state_(std::make_shared<const State>(std::move(tree), std::move(volumes), std::move(seen), nullptr)) {}

Snapshot::Snapshot(std::shared_ptr<const FusedTree> tree, std::vector<PaintedVolume> volumes,
                   const Snapshot& previous, std::shared_ptr<const SeenStamps> seen)
    : state_(std::make_shared<const State>(std::move(tree), std::move(volumes), std::move(seen),
                                           &previous.state_->fields)) {}

double Snapshot::resolution() const { return state_->tree->getResolution(); }
const std::vector<PaintedVolume>& Snapshot::volumes() const { return state_->volumes; }
const FusedTree& Snapshot::tree() const { return *state_->tree; }
double Snapshot::log_odds_of_a_look() const { return -static_cast<double>(tree().getProbMissLog()); }

namespace {

VoxelCounts counted(const FusedTree& tree) {
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
  std::call_once(state_->counted, [this] { state_->counts = counted(tree()); });
  return state_->counts;
}

bool Snapshot::holds_any(std::initializer_list<VoxelState> states) const {
  const FusedNode* root = tree().getRoot();
  return root != nullptr && any_leaf_is(tree(), *root, states);
}

namespace {

/// How far stored leaves reach along an axis, up or down, in cells. Asks first where it may be farthest, so
/// that most of the tree cannot be farther.
struct Extent {
  int axis;
  bool up;
  int farthest = std::numeric_limits<int>::min();  ///< of the cubes' faces; negative numbers when down

  void extend(const FusedNode& node, const CellCube& cube) {
    const int face = up ? cube.corner[axis] + cube.edge : -cube.corner[axis];
    if (face <= farthest) return;
    if (!node.has_children()) {
      farthest = face;
      return;
    }
    const int middle = cube.corner[axis] + cube.edge / 2;
    for (const bool far : {true, false}) {
      if (!far && (up ? middle : -middle) <= farthest) return;
      for (unsigned i = 0; i < 8; ++i) {
        const bool is_upper = (i >> axis & 1U) != 0;
        if ((is_upper == up) != far) continue;
        if (const FusedNode* child = node.child(i)) extend(*child, cube.child(i));
      }
    }
  }
};

}  // namespace

Eigen::AlignedBox3d Snapshot::bounds() const {
  std::call_once(state_->bounds_known, [this] {
    const FusedNode* root = tree().getRoot();
    if (root == nullptr) return;
    for (int axis = 0; axis < 3; ++axis) {
      Extent down{axis, false}, up{axis, true};
      down.extend(*root, CellCube{});
      up.extend(*root, CellCube{});
      state_->bounds.min()[axis] = -down.farthest;
      state_->bounds.max()[axis] = up.farthest;
    }
  });
  const Eigen::AlignedBox3i& cells = state_->bounds;
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
  tree().visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    const Voxel voxel = voxel_of(tree(), node, cube);
    if (voxel.state != VoxelState::unknown) visit(voxel);
  });
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
