#include "mapping/files/octree_reader.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "mapping/files/map_file.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

constexpr std::size_t tree_levels = 16;

/// Takes bytes off the data, little-endian as OctoMap writes them.
class Bytes {
 public:
  Bytes(std::string_view data, const std::filesystem::path& file) : data_(data), file_(file) {}

  /// The next `count` bytes.
  const char* take(std::size_t count) {
    if (data_.size() - at_ < count) refuse("the tree is cut off");
    const char* bytes = data_.data() + at_;
    at_ += count;
    return bytes;
  }
  bool at_end() const { return at_ == data_.size(); }

  [[noreturn]] void refuse(const std::string& reason) const {
    throw DamagedFile("'" + file_.string() + "' is damaged: " + reason);
  }

 private:
  std::string_view data_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0;
};

template <class Field>
Field field(const char* bytes) {
  Field value;
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

/// A tree that takes its nodes in file order: each node before its children.
class GrowingTree : public FusedTree {
 public:
  GrowingTree(double voxel_edge, bool prune) : FusedTree(voxel_edge), prunes_(prune) { clearKeyRays(); }

  std::size_t nodes() const { return nodes_; }

  /// Reads node after node: `read(node, level)` fills one and returns the mask of the children that follow.
  template <class Read>
  void grow(const Read& read) {
    root = new FusedNode();
    tree_size = 1;
    size_changed = true;
    FusedNode* node = root;
    for (std::size_t level = 0;;) {
      ++nodes_;
      open_[level] = {node, read(*node, level), node->has_children()};
      while (open_[level].missing == 0) {
        close(open_[level]);
        if (level == 0) return;
        --level;
      }
      Open& parent = open_[level];
      const auto index = static_cast<unsigned>(std::countr_zero(parent.missing));
      parent.missing &= parent.missing - 1;
      parent.is_inner = true;
      node = createNodeChild(parent.node, index);
      ++level;
    }
  }

 private:
  /// A node whose children are still being read.
  struct Open {
    FusedNode* node = nullptr;
    unsigned missing = 0;  ///< children to come, bit by bit
    bool is_inner = false;
  };

  void close(const Open& open) {
    if (open.is_inner && !(prunes_ && pruneNode(open.node))) open.node->updateOccupancyChildren();
  }

  bool prunes_;
  std::size_t nodes_ = 0;
  std::array<Open, tree_levels + 1> open_{};
};

/// Log-odds, painted mask, observed flag, mask of children.
void read_fused(GrowingTree& tree, Bytes& bytes) {
  tree.grow([&](FusedNode& node, std::size_t level) -> unsigned {
    const char* at = bytes.take(8);
    const auto log_odds = field<float>(at);
    const auto painted = field<std::uint16_t>(at + 4);
    const auto observed = field<std::uint8_t>(at + 6);
    const auto children = field<std::uint8_t>(at + 7);
    if (!std::isfinite(log_odds)) bytes.refuse("a node's log-odds are not finite");
    if (painted >> FusedTree::volume_limit != 0 || observed > 1) bytes.refuse("a node has unknown flags");
    if (children != 0 && level == tree_levels) bytes.refuse("the tree has more than 16 levels");
    if (children != 0) return children;
    if (painted == 0 && observed == 0) bytes.refuse("a leaf is neither observed nor painted");
    if (observed != 0) node.observe(log_odds);
    node.add_paint(painted);
    return 0;
  });
}

/// Log-odds, `ignored` bytes of colour or time, mask of children.
void read_stock(GrowingTree& tree, Bytes& bytes, std::size_t ignored) {
  tree.grow([&](FusedNode& node, std::size_t level) -> unsigned {
    const char* at = bytes.take(sizeof(float) + ignored + 1);
    const auto log_odds = field<float>(at);
    const auto children = field<std::uint8_t>(at + sizeof(float) + ignored);
    if (!std::isfinite(log_odds)) bytes.refuse("a node's log-odds are not finite");
    if (children != 0 && level == tree_levels) bytes.refuse("the tree has more than 16 levels");
    if (children == 0) node.observe(log_odds);
    return children;
  });
}

/// Two bits a child: 0 unknown, 1 free leaf, 2 occupied leaf, 3 inner node with two bytes of its own further
/// on. Returns the number of nodes.
std::size_t read_binary(GrowingTree& tree, Bytes& bytes) {
  std::size_t leaves = 0;
  tree.grow([&](FusedNode& node, std::size_t level) -> unsigned {
    const auto codes = field<std::uint16_t>(bytes.take(2));
    if (codes == 0) bytes.refuse("an inner node has no children");
    if (level == tree_levels) bytes.refuse("the tree has more than 16 levels");
    unsigned inner = 0;
    for (unsigned child = 0; child < 8; ++child) {
      const unsigned code = (unsigned{codes} >> (2 * child)) & 3U;
      if (code == 3) inner |= 1U << child;
      if (code == 0 || code == 3) continue;
      ++leaves;
      tree.createNodeChild(&node, child)
          ->observe(code == 1 ? tree.getClampingThresMinLog() : tree.getClampingThresMaxLog());
    }
    return inner;
  });
  return leaves + tree.nodes();
}

}  // namespace

std::shared_ptr<FusedTree> read_tree(const CheckedOctree& checked, const std::filesystem::path& file) {
  const bool is_ours = !checked.binary && checked.type == FusedTree::type_name;
  auto tree = std::make_shared<GrowingTree>(checked.resolution, !is_ours);
  Bytes bytes(checked.data, file);
  if (checked.nodes == 0) {
    if (!bytes.at_end()) bytes.refuse("an empty tree is followed by data");
    return tree;
  }
  std::size_t nodes = 0;
  if (checked.binary) {
    nodes = read_binary(*tree, bytes);
  } else {
    if (is_ours)
      read_fused(*tree, bytes);
    else
      read_stock(*tree, bytes, checked.type == "ColorOcTree" ? 3 : 0);
    nodes = tree->nodes();
  }
  if (nodes != checked.nodes) {
    bytes.refuse("it holds " + std::to_string(nodes) + " nodes where its header says " +
                 std::to_string(checked.nodes));
  }
  if (!bytes.at_end()) bytes.refuse("the tree is followed by other bytes");
  return tree;
}

}  // namespace clearway
