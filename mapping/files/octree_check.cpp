#include "mapping/files/octree_check.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>

#include "mapping/files/map_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

constexpr std::string_view text_header = "# Octomap OcTree file";
constexpr std::string_view binary_header = "# Octomap OcTree binary file";
constexpr std::size_t longest_foreign_header = 1U << 20U;

[[noreturn]] void refuse_tree(const std::filesystem::path& file, const std::string& reason) {
  throw DamagedFile("'" + file.string() + "' is damaged: " + reason);
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

bool is_known(std::string_view type) {
  return type == FusedTree::type_name || type == "OcTree" || type == "ColorOcTree" || type == "OcTreeStamped";
}

/// A .bt of OctoMap before 1.0 begins with numbers, not with text: 3, resolution, nodes. Nothing for others.
std::optional<CheckedOctree> first_binary_format(std::string_view bytes) {
  constexpr std::size_t length = sizeof(std::int32_t) + sizeof(double) + sizeof(std::uint32_t);
  std::int32_t kind = 0;
  std::uint32_t nodes = 0;
  CheckedOctree tree;
  if (bytes.size() < length) return std::nullopt;
  std::memcpy(&kind, bytes.data(), sizeof(kind));
  std::memcpy(&tree.resolution, bytes.data() + sizeof(kind), sizeof(double));
  std::memcpy(&nodes, bytes.data() + sizeof(kind) + sizeof(double), sizeof(nodes));
  if (kind != 3) return std::nullopt;
  tree.type = "OcTree";
  tree.binary = true;
  tree.nodes = nodes;
  tree.data = bytes.substr(length);
  return tree;
}

void require_resolution(const CheckedOctree& tree, bool is_stated, const std::filesystem::path& file) {
  if (!is_stated || !(tree.resolution >= 1e-4 && tree.resolution <= 100.0))
    refuse_tree(file, "its resolution ('res') is not a number in [0.0001, 100] m");
}

/// Letters, digits and the like, as a line of a header has, or nothing.
bool is_plain_text(std::string_view line) {
  constexpr std::size_t longest = 200;
  return line.size() <= longest &&
         std::all_of(line.begin(), line.end(), [](char c) { return c == '\t' || (c >= ' ' && c <= '~'); });
}

CheckedOctree parse_header(std::string_view bytes, const std::filesystem::path& file) {
  CheckedOctree tree;
  bool has_size = false, has_resolution = false;
  std::size_t at = 0;
  for (bool first = true;; first = false) {
    const auto end = bytes.find('\n', at);
    if (end == std::string_view::npos) refuse_tree(file, "the OctoMap header is cut off");
    std::string_view line = bytes.substr(at, end - at);
    at = end + 1;
    // As OctoMap reads it: by words, whatever ends the lines, keys that nobody knows skipped.
    line.remove_suffix(line.size() - (line.find_last_not_of(" \t\r") + 1));
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const auto space = line.find_first_of(" \t");
    const std::string_view key = line.substr(0, space);
    std::string_view value = space == std::string_view::npos ? "" : line.substr(space + 1);
    value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
    if (first) {
      tree.binary = line == binary_header;
      if (!tree.binary && line != text_header) refuse_tree(file, "it does not start with an OctoMap header");
    } else if (line == "data") {
      break;
    } else if (key == "id") {
      tree.type = value;
    } else if (key == "size") {
      has_size = parse(value, tree.nodes);
    } else if (key == "res") {
      has_resolution = parse(value, tree.resolution);
    } else if (!line.starts_with('#') && !is_plain_text(line)) {
      refuse_tree(file, "its header holds a line that is none of id, size, res and data");
    }
  }
  const bool has_comments = bytes.substr(0, at).find("\n# clearway ") != std::string_view::npos;
  tree.fused =
      !tree.binary && (tree.type == FusedTree::type_name || (tree.type == "ColorOcTree" && has_comments));
  if (!has_size) refuse_tree(file, "its header lacks the number of nodes ('size')");
  require_resolution(tree, has_resolution, file);
  tree.header = bytes.substr(0, at);
  tree.data = bytes.substr(at);
  return tree;
}

}  // namespace

std::string octree_header(bool binary, std::string_view type, std::size_t nodes, double resolution) {
  return std::string(binary ? binary_header : text_header) + "\nid " + std::string(type) + "\nsize " +
         std::to_string(nodes) + "\nres " + to_text(resolution) + "\ndata\n";
}

CheckedOctree check_octree(std::string_view bytes, const std::filesystem::path& file) {
  return check_octree_start(bytes, file, [&] { return is_sealed(bytes); });
}

CheckedOctree check_octree_start(std::string_view start, const std::filesystem::path& file,
                                 const std::function<bool()>& is_sealed) {
  if (const auto old = first_binary_format(start)) {
    require_resolution(*old, true, file);
    return *old;
  }
  CheckedOctree tree = parse_header(start, file);
  if (tree.fused && !is_sealed()) refuse_tree(file, "its checksum does not match its content");
  if (!tree.fused && tree.header.size() > longest_foreign_header)
    refuse_tree(file, "its header is longer than 1 MiB");
  if (!tree.binary && !is_known(tree.type)) {
    refuse_tree(file, "its tree type " + quote(tree.type) +
                          " is none of ClearwayFusedTree, OcTree, ColorOcTree, OcTreeStamped");
  }
  return tree;
}

std::string seal_line(std::string_view before, std::string_view after) {
  auto checksum = crc32_z(0, nullptr, 0);
  for (const std::string_view part : {before, after}) {
    checksum = crc32_z(checksum, reinterpret_cast<const Bytef*>(part.data()), part.size());
  }
  return seal_line(checksum, before.size() + after.size());
}

std::string seal_line(unsigned long checksum, std::size_t length) {
  std::array<char, 64> line{};
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
