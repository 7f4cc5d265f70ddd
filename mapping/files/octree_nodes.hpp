#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "mapping/files/octree_check.hpp"
#include "mapping/system/damaged_file.hpp"

namespace clearway {

/// Takes bytes off a file, little-endian as OctoMap writes them.
class NodeBytes {
 public:
  /// Gives the next piece, which lasts until it is asked again; empty at the end.
  using Refill = std::function<std::string_view()>;

  NodeBytes(std::string_view first, const std::filesystem::path& file, Refill refill = nullptr)
      : piece_(first), file_(file), refill_(std::move(refill)) {}

  /// The next `count` bytes, 16 at most; they last until the next call. @throws DamagedFile at the end.
  const char* take(std::size_t count) {
    if (piece_.size() < count) return take_across(count);
    const char* const bytes = piece_.data();
    piece_.remove_prefix(count);
    return bytes;
  }

  bool at_end() { return piece_.empty() && !refilled(); }

  [[noreturn]] void refuse(const std::string& reason) const {
    throw DamagedFile("'" + file_.string() + "' is damaged: " + reason);
  }

 private:
  bool refilled() {
    if (refill_) piece_ = refill_();
    return !piece_.empty();
  }

  const char* take_across(std::size_t count) {
    for (std::size_t have = 0; have < count; ++have) {
      if (piece_.empty() && !refilled()) refuse("the tree is cut off");
      seam_[have] = piece_.front();
      piece_.remove_prefix(1);
    }
    return seam_.data();
  }

  std::string_view piece_;
  const std::filesystem::path& file_;
  Refill refill_;
  std::array<char, 16> seam_{};
};

/// What a file says of one leaf.
struct FileLeaf {
  float log_odds = 0.0F;
  std::uint16_t painted = 0;
  bool observed = true;
};

/// Reads the nodes of an OctoMap file in one pass and without recursion, and checks each on the way: at most
/// 16 levels, finite log-odds, known flags. Calls of `sink`: `Place root()`, `Place child(Place, unsigned
/// index)` (what it returns is a place in the tree, a type of its own choice), `leaf(Place, FileLeaf)`, and
/// `close(Place)` for an inner node whose children are complete. Returns the number of nodes.
/// @param layout of the nodes; `data` is not used
template <class Sink>
class NodeReader {
 public:
  NodeReader(const CheckedOctree& layout, NodeBytes& bytes, Sink& sink)
      : bytes_(bytes), sink_(sink), is_ours_(layout.fused), binary_(layout.binary) {
    if (layout.type == "ColorOcTree") ignored_ = 3;
  }

  /// @param free, occupied log-odds of what a .bt file calls so
  std::size_t read(float free, float occupied) {
    auto place = sink_.root();
    for (std::size_t level = 0;;) {
      ++nodes_;
      const unsigned missing = binary_ ? read_binary(place, level, free, occupied) : read_node(place, level);
      open_[level] = {place, missing, binary_ || missing != 0};
      while (open_[level].missing == 0) {
        if (open_[level].is_inner) sink_.close(open_[level].place);
        if (level == 0) return nodes_;
        --level;
      }
      Open& parent = open_[level];
      const auto index = static_cast<unsigned>(std::countr_zero(parent.missing));
      parent.missing &= parent.missing - 1;
      place = sink_.child(parent.place, index);
      ++level;
    }
  }

 private:
  static constexpr std::size_t levels = 16;
  using Place = decltype(std::declval<Sink&>().root());

  /// A node whose children are still being read.
  struct Open {
    Place place{};
    unsigned missing = 0;  ///< children to come, bit by bit
    bool is_inner = false;
  };

  template <class Field>
  static Field field(const char* bytes) {
    Field value;
    std::memcpy(&value, bytes, sizeof(value));
    return value;
  }

  /// Ours: log-odds, painted mask, observed flag, mask of children. Stock: log-odds, bytes of colour that are
  /// ignored, mask of children. Returns the mask.
  unsigned read_node(const Place& place, std::size_t level) {
    const std::size_t size = is_ours_ ? 8 : 5 + ignored_;
    const char* at = bytes_.take(size);
    FileLeaf leaf{field<float>(at)};
    const auto children = field<std::uint8_t>(at + size - 1);
    if (!std::isfinite(leaf.log_odds)) bytes_.refuse("a node's log-odds are not finite");
    if (is_ours_) {
      leaf.painted = field<std::uint16_t>(at + 4);
      const auto observed = field<std::uint8_t>(at + 6);
      if (leaf.painted >> 15U != 0 || observed > 1) bytes_.refuse("a node has unknown flags");
      leaf.observed = observed != 0;
    }
    if (children != 0 && level == levels) bytes_.refuse("the tree has more than 16 levels");
    if (children != 0) return children;
    if (leaf.painted == 0 && !leaf.observed) bytes_.refuse("a leaf is neither observed nor painted");
    sink_.leaf(place, leaf);
    return 0;
  }

  /// Two bits a child: 0 unknown, 1 free leaf, 2 occupied leaf, 3 inner node with two bytes of its own
  /// further on.
  unsigned read_binary(const Place& place, std::size_t level, float free, float occupied) {
    const auto codes = field<std::uint16_t>(bytes_.take(2));
    if (codes == 0) bytes_.refuse("an inner node has no children");
    if (level == levels) bytes_.refuse("the tree has more than 16 levels");
    unsigned inner = 0;
    for (unsigned index = 0; index < 8; ++index) {
      const unsigned code = (unsigned{codes} >> (2 * index)) & 3U;
      if (code == 3) inner |= 1U << index;
      if (code == 0 || code == 3) continue;
      ++nodes_;
      sink_.leaf(sink_.child(place, index), {code == 1 ? free : occupied});
    }
    return inner;
  }

  NodeBytes& bytes_;
  Sink& sink_;
  bool is_ours_, binary_;
  std::size_t ignored_ = 0, nodes_ = 0;
  std::array<Open, levels + 1> open_{};
};

/// Reads all nodes into `sink`, and checks that there are as many as the header says, with nothing behind.
/// @throws DamagedFile naming the file and what is wrong.
template <class Sink>
void read_nodes(const CheckedOctree& layout, NodeBytes& bytes, Sink& sink, float free, float occupied) {
  if (layout.nodes == 0) {
    if (!bytes.at_end()) bytes.refuse("an empty tree is followed by data");
    return;
  }
  const std::size_t nodes = NodeReader<Sink>(layout, bytes, sink).read(free, occupied);
  if (nodes != layout.nodes) {
    bytes.refuse("it holds " + std::to_string(nodes) + " nodes where its header says " +
                 std::to_string(layout.nodes));
  }
  if (!bytes.at_end()) bytes.refuse("the tree is followed by other bytes");
}

}  // namespace clearway
