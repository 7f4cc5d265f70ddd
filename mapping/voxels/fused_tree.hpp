#pragma once

// With fused_node.hpp the only header that includes OctoMap; include it from .cpp files only.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mapping/voxels/fused_node.hpp"
#include "mapping/voxels/hand_edits.hpp"
#include "mapping/voxels/integration.hpp"
#include "mapping/voxels/scan_agreement.hpp"
#include "mapping/voxels/sphere.hpp"
#include "mapping/voxels/voxel_state.hpp"

namespace clearway {

class ScanGrid;

/// Smallest corner of a cube of voxels in cells, and its edge: the cube spans
/// [corner, corner + edge] * resolution in metres. Cells run from -32768 to 32767.
struct CellCube {
  Eigen::Vector3i corner = Eigen::Vector3i::Constant(-32768);
  int edge = 65536;

  CellCube child(unsigned index) const {
    const int half = edge / 2;
    const Eigen::Vector3i step(index & 1U ? half : 0, index & 2U ? half : 0, index & 4U ? half : 0);
    return {corner + step, half};
  }
  /// Voxels in the cube.
  std::size_t volume() const { return static_cast<std::size_t>(edge) * edge * edge; }
};

/// What painting one sphere did; see PaintCounts.
struct PaintTally {
  std::size_t painted = 0, newly = 0, conflicts = 0;
  std::vector<CellCube>
      new_conflicts{};  ///< cubes of occupied voxels that this volume had not painted before
};

/// What repainting changed, in voxels.
struct RepaintTally {
  std::size_t painted = 0, unpainted = 0;
};

/// The one store of sensors' evidence and paint: an OctoMap tree of FusedNodes, 16 levels deep.
///
/// Persistent: a copy shares all nodes with the original and costs nothing; a writer copies the nodes on its
/// way to what it changes, when another tree holds them too. So copies may be read by other threads while the
/// original is written. This holds for the functions of this class and for OctoMap's updateNode and
/// insertPointCloud; its other writing functions (setNodeValue, deleteNode, expand, prune, ...) may only be
/// used on a tree that shares nothing.
class FusedTree : public octomap::OccupancyOcTreeBase<FusedNode> {
 public:
  static constexpr const char* type_name = "ClearwayFusedTree";
  static constexpr int volume_limit = 15;

  explicit FusedTree(double voxel_edge) : OccupancyOcTreeBase<FusedNode>(voxel_edge) {}
  FusedTree(const FusedTree& other);  ///< shares all nodes
  FusedTree& operator=(const FusedTree&) = delete;
  ~FusedTree() override;
  void clear() { release_root(); }

  FusedTree* create() const override { return new FusedTree(resolution); }
  std::string getTreeType() const override { return type_name; }

  /// Makes octomap::AbstractOcTree::read know this type. Call it before reading; cheap and thread safe.
  static void register_type();

  /// A sensor's evidence, clamped; the first one starts from log-odds 0.
  void updateNodeLogOdds(FusedNode* node, const float& update) const override;

  /// Paints with bit `volume` the voxels that lie wholly inside `sphere`; descends to single voxels (or
  /// paints a cube that lies inside as a whole) and prunes on the way back.
  PaintTally paint(int volume, const Sphere& sphere);

  /// Makes the paint of `volume` agree with the list of its spheres again after some of them changed: a voxel
  /// is painted when it lies wholly inside one of `spheres`. Looks only at voxels wholly inside one of
  /// `changed`, which must hold the spheres that were in the list before or are now, but not both. Afterwards
  /// the tree is the one that only ever was painted with `spheres`.
  RepaintTally repaint(int volume, const std::vector<Sphere>& changed, const std::vector<Sphere>& spheres);

  /// Sets one voxel to an observed log-odds; leaves inner nodes and pruning to finish().
  void set_observed(const octomap::OcTreeKey& key, float log_odds);
  /// Makes one cube of voxels a leaf of this content; leaves inner nodes and pruning to finish().
  /// Precondition: nothing is stored there.
  void set_leaf(const CellCube& cube, const FusedNode& content);
  /// Updates inner nodes and prunes, after set_observed or set_leaf.
  void finish();

  /// Applies one scan: a miss to each voxel that is free in `grid` and not occupied, a hit to each occupied
  /// one, as OccupancyUpdate says; in `compatible` integration the tree that updateNode makes of them one by
  /// one. Takes the occupied bits out of the free ones.
  /// @param threads >= 1; the result does not depend on it.
  void update(ScanGrid& grid, Integration integration = Integration::compatible, int threads = 1);

  /// Makes one observed voxel unknown again; its paint stays. Prunes and updates the nodes above.
  /// Precondition: something is stored there.
  void take_back(const Eigen::Vector3i& cell);

  /// Makes one voxel observed and as free as can be, and paints it with `volumes` (bits). Prunes and updates
  /// the nodes above.
  void free_voxel(const Eigen::Vector3i& cell, std::uint16_t volumes);
  /// The same without paint, because somebody says so: with by_hand_log_odds(), until a sensor looks again.
  void free_voxel_by_hand(const Eigen::Vector3i& cell);
  /// The next above the lowest: it marks what is free by hand, and counts like it.
  float by_hand_log_odds() const { return std::nextafter(getClampingThresMinLog(), 0.0F); }
  /// Makes one voxel observed and as occupied as can be; its paint stays. Prunes and updates the nodes above.
  void occupy_voxel(const Eigen::Vector3i& cell);

  /// How the scans agreed with the map before them. A copy has it, too.
  const ScanAgreement& agreement() const { return agreement_; }
  void add_agreement(const ScanAgreement& more) { agreement_.add(more); }

  /// Which integration the scans in it came by; update() keeps it. A copy has it, too.
  MapIntegration integration() const { return integration_; }
  void set_integration(MapIntegration integration) { integration_ = integration; }

  VoxelState state(const FusedNode& node) const;
  /// Log-odds at and over which an observed voxel is occupied, exactly as given (setOccupancyThres rounds).
  void set_occupied_log_odds(float log_odds) { occ_prob_thres_log = log_odds; }
  /// Between which log-odds evidence stays, exactly as given (setClampingThresMin and Max round).
  void set_clamping_log_odds(float least, float most) {
    clamping_thres_min = least;
    clamping_thres_max = most;
  }
  /// How many records of a damaged recording went into the tree, where one did. A copy has it, too.
  std::optional<std::uint64_t> records_before_damage() const { return records_before_damage_; }
  void set_records_before_damage(std::uint64_t records) { records_before_damage_ = records; }

  /// What somebody changed in the map by hand. A copy has it, too.
  const HandEdits& hand_edits() const { return hand_edits_; }
  void add_hand_edits(const HandEdits& more) { hand_edits_.add(more); }

  /// Cell of a coordinate with OctoMap's own rounding; none when it is not finite or outside the key range.
  std::optional<Eigen::Vector3i> cell(const Eigen::Vector3d& point) const;

  /// The leaf that holds a cell, and its cube; null when nothing is stored there.
  const FusedNode* find_leaf(const Eigen::Vector3i& cell, CellCube& cube) const;

  /// Calls `visit(const FusedNode&, const CellCube&)` for each leaf with the cube of voxels it stands for,
  /// children in index order.
  template <class Visit>
  void visit_leaves(const Visit& visit) const;

  /// The same for the leaves whose cubes overlap the cells first..last (inclusive).
  template <class Visit>
  void visit_leaves(const Eigen::Vector3i& first, const Eigen::Vector3i& last, const Visit& visit) const;

  /// Calls `visit(const FusedNode* before, const FusedNode* now, const CellCube&)` for cubes that cover
  /// everything that differs from another version of this tree; each is a leaf, or null for "nothing stored",
  /// in both versions. Walks only the nodes that the two do not share.
  template <class Visit>
  void visit_changes(const FusedTree& before, const Visit& visit) const;

  // OctoMap's own, for nodes that may be shared.
  bool pruneNode(FusedNode* node) override;
  using OccupancyOcTreeBase<FusedNode>::updateNode;
  FusedNode* updateNode(const octomap::OcTreeKey& key, float update, bool lazy = false) override;

 private:
  struct Brush;
  class ScanUpdate;
  MapIntegration integration_ = MapIntegration::none;
  ScanAgreement agreement_;
  HandEdits hand_edits_;

  void release_root();
  FusedNode* update_below(FusedNode& node, bool just_created, unsigned depth, const octomap::OcTreeKey& key,
                          float update, bool lazy);

  struct Repainting;
  void repaint_cube(FusedNode& node, bool just_created, const Repainting& work);
  void repaint_all(FusedNode& node, bool paint, const CellCube& cube, const Repainting& work);
  void take_back_below(FusedNode& node, int level, const Eigen::Vector3i& cell);
  void set_below(FusedNode& node, bool just_created, int level, const Eigen::Vector3i& cell, float log_odds,
                 std::uint16_t volumes);
  bool may_be_painted(const FusedNode& node, unsigned index, bool just_created, std::uint16_t bit) const;
  void remove_child(FusedNode& node, unsigned index);

  /// The root, made if need be, that this tree alone holds.
  FusedNode& root_for_writing(bool& created);
  /// FusedNode::child_for_writing of a node in this tree.
  FusedNode& child_for_writing(FusedNode& node, unsigned index, bool just_created, bool& created);

  std::optional<std::uint64_t> records_before_damage_;
};

template <class Visit>
void visit_leaves_below(const FusedNode& node, const CellCube& cube, const Visit& visit) {
  if (!node.has_children()) return visit(node, cube);
  for (unsigned i = 0; i < 8; ++i) {
    if (node.child(i) != nullptr) visit_leaves_below(*node.child(i), cube.child(i), visit);
  }
}

template <class Visit>
void visit_leaves_below(const FusedNode& node, const CellCube& cube, const Eigen::Vector3i& first,
                        const Eigen::Vector3i& last, const Visit& visit) {
  const Eigen::Array3i low = cube.corner.array(), high = low + (cube.edge - 1);
  if ((low > last.array()).any() || (high < first.array()).any()) return;
  if ((low >= first.array()).all() && (high <= last.array()).all())
    return visit_leaves_below(node, cube, visit);
  if (!node.has_children()) return visit(node, cube);
  for (unsigned i = 0; i < 8; ++i) {
    if (node.child(i) != nullptr) visit_leaves_below(*node.child(i), cube.child(i), first, last, visit);
  }
}

template <class Visit>
void FusedTree::visit_leaves(const Eigen::Vector3i& first, const Eigen::Vector3i& last,
                             const Visit& visit) const {
  if (root != nullptr) visit_leaves_below(*root, CellCube{}, first, last, visit);
}

template <class Visit>
void FusedTree::visit_leaves(const Visit& visit) const {
  visit_leaves(Eigen::Vector3i::Constant(-32768), Eigen::Vector3i::Constant(32767), visit);
}

template <class Visit>
void visit_changes_below(const FusedNode* before, const FusedNode* now, const CellCube& cube,
                         const Visit& visit) {
  if (before == now) return;
  const bool before_splits = before != nullptr && before->has_children();
  const bool now_splits = now != nullptr && now->has_children();
  if (!before_splits && !now_splits) {
    if (before == nullptr || now == nullptr || !(*before == *now)) visit(before, now, cube);
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    visit_changes_below(before_splits ? before->child(i) : before, now_splits ? now->child(i) : now,
                        cube.child(i), visit);
  }
}

template <class Visit>
void FusedTree::visit_changes(const FusedTree& before, const Visit& visit) const {
  visit_changes_below(before.root, root, CellCube{}, visit);
}

/// Copies a tree into another type of OctoMap tree, leaf by leaf at the same depth. `Tree` is an
/// octomap::OccupancyOcTreeBase; `convert` fills a leaf of it.
template <class Tree>
class MirrorTree : public Tree {
 public:
  using Tree::Tree;

  template <class Source, class Convert>
  void mirror(const Source& source, const Convert& convert) {
    this->clear();
    if (source.getRoot() == nullptr) return;
    this->root = new std::remove_pointer_t<decltype(this->root)>();
    this->tree_size = 1;
    this->size_changed = true;
    mirror_node(source, *source.getRoot(), *this->root, convert);
  }

 private:
  template <class Source, class SourceNode, class Node, class Convert>
  void mirror_node(const Source& source, const SourceNode& from, Node& to, const Convert& convert) {
    if (!source.nodeHasChildren(&from)) return convert(from, to);
    for (unsigned i = 0; i < 8; ++i) {
      if (!source.nodeChildExists(&from, i)) continue;
      mirror_node(source, *source.getNodeChild(&from, i), *this->createNodeChild(&to, i), convert);
    }
    to.updateOccupancyChildren();
  }
};

}  // namespace clearway
