#include "mapping/files/ply_header.hpp"

#include <algorithm>
#include <array>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace clearway {
namespace {

[[noreturn]] void refuse_ply_header() { throw std::runtime_error("its header is cut off or garbled"); }

/// Bytes of a number in a binary .ply.
std::uint64_t bytes_of(const std::string& type) {
  static constexpr std::array<std::pair<std::string_view, int>, 16> sizes{{{"char", 1},
                                                                           {"uchar", 1},
                                                                           {"short", 2},
                                                                           {"ushort", 2},
                                                                           {"int", 4},
                                                                           {"uint", 4},
                                                                           {"float", 4},
                                                                           {"double", 8},
                                                                           {"int8", 1},
                                                                           {"uint8", 1},
                                                                           {"int16", 2},
                                                                           {"uint16", 2},
                                                                           {"int32", 4},
                                                                           {"uint32", 4},
                                                                           {"float32", 4},
                                                                           {"float64", 8}}};
  for (const auto& [name, size] : sizes) {
    if (type == name) return static_cast<std::uint64_t>(size);
  }
  refuse_ply_header();
}

}  // namespace

PlyHeader ply_header(std::string_view content) {
  PlyHeader header;
  while (true) {
    const std::size_t end = content.find('\n', header.length);
    if (end == std::string_view::npos) refuse_ply_header();
    std::istringstream line(
        std::string(content.substr(header.length, std::min<std::size_t>(end - header.length, 1000))));
    line.imbue(std::locale::classic());
    header.length = end + 1;
    std::string key, word;
    line >> key >> word;
    if (key == "end_header") return header;
    if (key == "format") header.format = word;
    if (key == "element" && !(line >> header.elements.emplace_back().count)) refuse_ply_header();
    if (key != "property") continue;
    if (header.elements.empty()) refuse_ply_header();
    PlyProperty property;
    if (word == "list") {
      line >> word;
      property.count_bytes = bytes_of(word);
      line >> word;
    }
    property.bytes = bytes_of(word);
    header.elements.back().properties.push_back(property);
  }
}

}  // namespace clearway
