#include "mapping/octree_check.hpp"

#include <zlib.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "mapping/fused_tree.hpp"
#include "mapping/map_file.hpp"

namespace clearway {
namespace {

constexpr int tree_depth = 16;
constexpr std::string_view text_header = "# Octomap OcTree file";
constexpr std::string_view binary_header = "# Octomap OcTree binary file";
constexpr std::size_t longest_foreign_header = 1U << 20U;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw DamagedFile("'" + file.string() + "' is damaged: " + reason);
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

/// Bytes that one node of a registered tree type writes before its children byte; 0 for an unknown type.
std::size_t payload_of(std::string_view type) {
  if (type == "OcTree" || type == "OcTreeStamped") return 4;
  if (type == "ColorOcTree") return 7;
  if (type == FusedTree::type_name) return 7;
  return 0;
}

CheckedOctree parse_header(std::string_view bytes, const std::filesystem::path& file) {
  CheckedOctree tree;
  bool has_size = false, has_resolution = false;
  std::size_t at = 0;
  for (bool first = true;; first = false) {
    const auto end = bytes.find('\n', at);
    if (end == std::string_view::npos) refuse(file, "the OctoMap header is cut off");
    const std::string_view line = bytes.substr(at, end - at);
    at = end + 1;
    const auto space = line.find(' ');
    const std::string_view key = line.substr(0, space);
    const std::string_view value = space == std::string_view::npos ? "" : line.substr(space + 1);
    if (first) {
      tree.binary = line == binary_header;
      if (!tree.binary && line != text_header) refuse(file, "it does not start with an OctoMap header");
    } else if (line == "data") {
      break;
    } else if (key == "id") {
      tree.type = value;
    } else if (key == "size") {
      has_size = parse(value, tree.nodes);
    } else if (key == "res") {
      has_resolution = parse(value, tree.resolution);
    } else if (!line.starts_with('#')) {
      refuse(file, "its header holds a line that is none of id, size, res and data");
    }
  }
  if (!has_size) refuse(file, "its header lacks the number of nodes ('size')");
  if (!has_resolution || !(tree.resolution >= 1e-4 && tree.resolution <= 100.0)) {
    refuse(file, "its resolution ('res') is not a number in [0.0001, 100] m");
  }
  tree.header = bytes.substr(0, at);
  tree.data = bytes.substr(at);
  return tree;
}

/// Walks a tree in file order without recursion: `read_node(depth)` returns how many children follow.
template <class ReadNode>
void walk(const ReadNode& read_node) {
  std::array<int, tree_depth + 1> pending{};
  int depth = 0;
  while (depth >= 0) {
    pending[static_cast<std::size_t>(depth)] = read_node(depth);
    while (depth >= 0 && pending[static_cast<std::size_t>(depth)] == 0) --depth;
    if (depth >= 0) --pending[static_cast<std::size_t>(depth++)];
  }
}

/// Takes the fields of one node off the data.
class NodeReader {
 public:
  NodeReader(std::string_view data, const std::filesystem::path& file) : data_(data), file_(file) {}

  template <class Field>
  Field take() {
    Field field;
    if (data_.size() - at_ < sizeof(field)) refuse(file_, "the tree is cut off");
    std::memcpy(&field, data_.data() + at_, sizeof(field));
    at_ += sizeof(field);
    return field;
  }
  void skip(std::size_t bytes) {
    if (data_.size() - at_ < bytes) refuse(file_, "the tree is cut off");
    at_ += bytes;
  }
  bool at_end() const { return at_ == data_.size(); }

 private:
  std::string_view data_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0;
};

std::size_t check_text_tree(const CheckedOctree& tree, NodeReader& reader,
                            const std::filesystem::path& file) {
  const std::size_t payload = payload_of(tree.type);
  const bool fused = tree.type == FusedTree::type_name;
  std::size_t nodes = 0;
  walk([&](int depth) {
    ++nodes;
    if (!std::isfinite(reader.take<float>())) refuse(file, "a node's log-odds are not finite");
    bool known = true;
    if (fused) {
      const auto painted = reader.take<std::uint16_t>();
      const auto observed = reader.take<std::uint8_t>();
      if (painted >> FusedTree::volume_limit != 0 || observed > 1) refuse(file, "a node has unknown flags");
      known = painted != 0 || observed != 0;
    } else {
      reader.skip(payload - sizeof(float));
    }
    const int children = std::popcount(reader.take<std::uint8_t>());
    if (children > 0 && depth == tree_depth) refuse(file, "the tree has more than 16 levels");
    if (children == 0 && !known) refuse(file, "a leaf is neither observed nor painted");
    return children;
  });
  return nodes;
}

/// Two bits a child: 00 unknown, 01 and 10 leaf, 11 inner node with two bytes of its own further on.
std::size_t check_binary_tree(NodeReader& reader, const std::filesystem::path& file) {
  std::size_t nodes = 1;
  walk([&](int depth) {
    const auto bits = reader.take<std::uint16_t>();
    int inner = 0, leaves = 0;
    for (int child = 0; child < 8; ++child) {
      const int code = (bits >> (2 * child)) & 3;
      if (code == 3) ++inner;
      if (code == 1 || code == 2) ++leaves;
    }
    if (inner + leaves == 0) refuse(file, "an inner node has no children");
    if (depth == tree_depth) refuse(file, "the tree has more than 16 levels");
    nodes += static_cast<std::size_t>(inner + leaves);
    return inner;
  });
  return nodes;
}

}  // namespace

std::string octree_header(bool binary, std::string_view type, std::size_t nodes, double resolution) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), resolution);
  return std::string(binary ? binary_header : text_header) + "\nid " + std::string(type) + "\nsize " +
         std::to_string(nodes) + "\nres " + std::string(digits.data(), end.ptr) + "\ndata\n";
}

CheckedOctree check_octree(std::string_view bytes, const std::filesystem::path& file) {
  CheckedOctree tree = parse_header(bytes, file);
  const bool fused = tree.type == FusedTree::type_name;
  if (fused && !is_sealed(bytes)) refuse(file, "its checksum does not match its content");
  if (!fused && tree.header.size() > longest_foreign_header) refuse(file, "its header is longer than 1 MiB");
  if (!tree.binary && payload_of(tree.type) == 0) {
    refuse(file, "its tree type '" + tree.type +
                     "' is none of ClearwayFusedTree, OcTree, ColorOcTree, OcTreeStamped");
  }
  if (tree.nodes == 0) {
    if (!tree.data.empty()) refuse(file, "an empty tree is followed by data");
    return tree;
  }
  NodeReader reader(tree.data, file);
  const std::size_t nodes =
      tree.binary ? check_binary_tree(reader, file) : check_text_tree(tree, reader, file);
  if (nodes != tree.nodes) {
    refuse(file, "it holds " + std::to_string(nodes) + " nodes where its header says " +
                     std::to_string(tree.nodes));
  }
  if (!reader.at_end()) refuse(file, "the tree is followed by other bytes");
  return tree;
}

std::string seal_line(std::string_view before, std::string_view after) {
  auto checksum = crc32_z(0, nullptr, 0);
  for (const std::string_view part : {before, after}) {
    checksum = crc32_z(checksum, reinterpret_cast<const Bytef*>(part.data()), part.size());
  }
  std::array<char, 64> line{};
  const std::size_t length = before.size() + after.size();
  std::snprintf(line.data(), line.size(), "# clearway seal crc32 %08lx bytes %020zu\n", checksum, length);
  return line.data();
}

bool is_sealed(std::string_view bytes) {
  const auto first = bytes.find('\n');
  if (first == std::string_view::npos) return false;
  const auto second = bytes.find('\n', first + 1);
  if (second == std::string_view::npos) return false;
  const std::string_view before = bytes.substr(0, first + 1);
  const std::string_view after = bytes.substr(second + 1);
  return bytes.substr(first + 1, second - first) == seal_line(before, after);
}

}  // namespace clearway
