#include "mapping/files/octree_reader.hpp"

#include "mapping/files/octree_nodes.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

/// A tree that takes its nodes in file order: each node before its children.
class GrowingTree : public FusedTree {
 public:
  GrowingTree(double voxel_edge, bool prune) : FusedTree(voxel_edge), prunes_(prune) { clearKeyRays(); }

  FusedNode* new_root() {
    FusedTree::root = new FusedNode();
    tree_size = 1;
    size_changed = true;
    return FusedTree::root;
  }

  FusedNode* new_child(FusedNode* node, unsigned index) { return createNodeChild(node, index); }

  void close(FusedNode* node) {
    if (!(prunes_ && pruneNode(node))) node->updateOccupancyChildren();
  }

 private:
  bool prunes_;
};

/// What NodeReader asks of a sink.
struct TreeSink {
  GrowingTree& tree;

  FusedNode* root() { return tree.new_root(); }
  FusedNode* child(FusedNode* node, unsigned index) { return tree.new_child(node, index); }
  void leaf(FusedNode* node, const FileLeaf& leaf) {
    if (leaf.observed) node->observe(leaf.log_odds);
    node->add_paint(leaf.painted);
  }
  void close(FusedNode* node) { tree.close(node); }
};

}  // namespace

std::shared_ptr<FusedTree> read_tree(const CheckedOctree& checked, const std::filesystem::path& file) {
  auto tree = std::make_shared<GrowingTree>(checked.resolution, !checked.fused);
  NodeBytes bytes(checked.data, file);
  TreeSink sink{*tree};
  read_nodes(checked, bytes, sink, tree->getClampingThresMinLog(), tree->getClampingThresMaxLog());
  return tree;
}

}  // namespace clearway
