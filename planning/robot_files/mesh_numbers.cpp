#include "planning/robot_files/mesh_numbers.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string_view>

#include "mapping/files/number_words.hpp"
#include "mapping/files/ply_header.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

void require_number(std::string_view word, std::size_t line) {
  if (!parsed_number(word))
    throw std::runtime_error("line " + std::to_string(line) + " has " + quote(word) + ", expected a number");
}

void require_numbers(std::string_view words, std::size_t line) {
  for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
    if (word.front() == '#') return;
    require_number(word, line);
  }
}

/// Calls `visit` with each line, its number from 1 behind it, until that says no.
void visit_lines(std::string_view text, const std::function<bool(std::string_view, std::size_t)>& visit) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (!visit(text.substr(0, end), number)) return;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

/// "v x y z", with a weight or a colour behind it. A line that ends in '\' goes on in the next one.
void check_obj_numbers(std::string_view content) {
  bool goes_on = false;
  visit_lines(content, [&](std::string_view line, std::size_t number) {
    const std::size_t last = line.find_last_not_of(" \t\r");
    const bool is_continued = last != std::string_view::npos && line[last] == '\\';
    if (is_continued) line = line.substr(0, last);
    if (goes_on || next_word(line) == "v") {
      require_numbers(line, number);
      goes_on = is_continued;
    }
    return true;
  });
}

/// A line for each element, all of it numbers.
void check_ply_numbers(const std::string& content) {
  const PlyHeader header = ply_header(content);
  if (header.format != "ascii") return;
  std::uint64_t elements = 0;
  for (const PlyElement& element : header.elements) elements += element.count;
  visit_lines(content,
              [&, first = content.data() + header.length](std::string_view line, std::size_t number) {
                if (line.data() < first) return true;
                if (elements == 0) return false;
                std::string_view rest = line;
                if (next_word(rest).empty()) return true;
                require_numbers(line, number);
                --elements;
                return true;
              });
}

/// "vertex x y z".
void check_stl_numbers(std::string_view content) {
  visit_lines(content, [](std::string_view line, std::size_t number) {
    if (next_word(line) == "vertex")
      for (int axis = 0; axis < 3; ++axis) require_number(next_word(line), number);
    return true;
  });
}

}  // namespace

void check_numbers_of_mesh(const std::string& content, const std::string& kind) {
  if (kind == "obj") check_obj_numbers(content);
  if (kind == "ply") check_ply_numbers(content);
  if (kind == "stl") check_stl_numbers(content);
}

}  // namespace clearway
