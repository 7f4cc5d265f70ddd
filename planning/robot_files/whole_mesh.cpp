#include "planning/robot_files/whole_mesh.hpp"

#include <cctype>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "mapping/files/ply_header.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse_ply_counts() {
  throw std::runtime_error("it holds fewer elements than its header says");
}

/// One line an element.
void check_text_ply(const PlyHeader& header, std::string_view data) {
  std::uint64_t lines = 0, elements = 0;
  bool is_blank = true;
  for (char c : data) {
    if (!std::isspace(static_cast<unsigned char>(c))) {
      if (is_blank) ++lines;
      is_blank = false;
    } else if (c == '\n') {
      is_blank = true;
    }
  }
  for (const PlyElement& element : header.elements) elements += element.count;
  if (lines < elements) refuse_ply_counts();
  if (lines > elements) throw std::runtime_error("it holds more data than its header says");
}

void check_ply(const std::string& content) {
  const PlyHeader header = ply_header(content);
  ply_vertices(header);
  for (const PlyElement& element : header.elements)
    if (element.count > content.size()) refuse_ply_counts();
  const std::string_view data = std::string_view(content).substr(header.length);
  if (header.format == "ascii") return check_text_ply(header, data);
  require_nothing_more(data.substr(bytes_of_elements(header, data)));
}

}  // namespace

std::size_t binary_stl_bytes(const std::string& content) {
  constexpr std::size_t head = 84, facet = 50;
  if (content.size() < head) return 0;
  std::uint32_t facets = 0;
  std::memcpy(&facets, content.data() + head - sizeof(facets), sizeof(facets));
  const std::uint64_t bytes = head + std::uint64_t{facets} * facet;
  if (facets == 0 || bytes > content.size()) return 0;
  const std::string_view rest = std::string_view(content).substr(bytes);
  const auto is_stl = [&] {
    if (rest.size() < head) return false;
    std::memcpy(&facets, rest.data() + head - sizeof(facets), sizeof(facets));
    return facets > 0 && head + std::uint64_t{facets} * facet <= rest.size();
  };
  if (is_stl()) throw std::runtime_error("it holds more data than its header says");
  return rest.empty() || rest.size() % facet != 0 ? bytes : 0;
}

void check_mesh_is_whole(const std::string& content, const std::string& kind) {
  if (content.empty()) throw std::runtime_error("it is empty");
  if (kind == "ply") check_ply(content);
}

}  // namespace clearway
