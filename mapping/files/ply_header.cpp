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

/// "red" of "red" and "diffuse_red"; empty for what is no colour.
std::string colour_of(const PlyProperty& property) {
  std::string name = property.name;
  if (name.starts_with("diffuse_")) name.erase(0, 8);
  const bool is_one = name == "red" || name == "green" || name == "blue" || name == "alpha";
  return is_one ? name : std::string();
}

bool are_colours_odd(const PlyElement& element) {
  const std::vector<PlyProperty>& all = element.properties;
  const auto is = [&](std::size_t i, const char* name) {
    return i < all.size() && colour_of(all[i]) == name;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (colour_of(all[i]).empty()) continue;
    if (!is(i, "red") || !is(i + 1, "green") || !is(i + 2, "blue")) return true;
    i += is(i + 3, "alpha") ? 3 : 2;
    for (std::size_t rest = i + 1; rest < all.size(); ++rest)
      if (!colour_of(all[rest]).empty()) return true;
  }
  return false;
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
    if (key == "element") {
      header.elements.push_back({word, 0, {}});
      if (!(line >> header.elements.back().count)) refuse_ply_header();
    }
    if (key != "property") continue;
    if (header.elements.empty()) refuse_ply_header();
    PlyProperty property;
    if (word == "list") {
      line >> word;
      property.count_bytes = bytes_of(word);
      line >> word;
    }
    property.bytes = bytes_of(word);
    line >> property.name;
    header.elements.back().properties.push_back(property);
  }
}

std::size_t bytes_of_elements(const PlyHeader& header, std::string_view data) {
  std::size_t at = 0;
  const auto take = [&](std::uint64_t size) {
    if (size > data.size() - at) throw std::runtime_error("it holds fewer elements than its header says");
    at += size;
    return data.substr(at - size, size);
  };
  for (const PlyElement& element : header.elements) {
    if (element.count > data.size()) take(data.size() + 1);
    if (std::none_of(element.properties.begin(), element.properties.end(),
                     [](const PlyProperty& property) { return property.count_bytes > 0; })) {
      std::uint64_t bytes = 0;
      for (const PlyProperty& property : element.properties) bytes += property.bytes;
      take(element.count * bytes);
      continue;
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        std::uint64_t count = 1;
        if (property.count_bytes > 0) {
          count = 0;
          std::string bytes(take(property.count_bytes));
          if (header.format == "binary_little_endian") std::reverse(bytes.begin(), bytes.end());
          for (unsigned char byte : bytes) count = count << 8U | byte;
        }
        take(std::min<std::uint64_t>(count, data.size() + 1) * property.bytes);
      }
    }
  }
  return at;
}

void require_nothing_more(std::string_view rest) {
  constexpr std::string_view blanks(" \t\r\n\0\x1a", 6);
  if (rest.find_first_not_of(blanks) != std::string_view::npos)
    throw std::runtime_error("it holds more data than its header says");
}

bool has_odd_colours(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(), are_colours_odd);
}

std::string with_nameless_colours(std::string_view content) {
  const PlyHeader header = ply_header(content);
  std::string text;
  for (std::size_t at = 0; at < header.length;) {
    const std::size_t end = content.find('\n', at) + 1;
    std::string line(content.substr(at, end - at));
    PlyProperty property;
    std::istringstream words(line);
    std::string key, type;
    if (words >> key >> type >> property.name && key == "property" && type != "list" &&
        !colour_of(property).empty())
      line = "property " + type + " unread_" + std::to_string(at) + "\n";
    text += line;
    at = end;
  }
  return text.append(content.substr(header.length));
}

}  // namespace clearway
