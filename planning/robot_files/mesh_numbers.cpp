#include "planning/robot_files/mesh_numbers.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "mapping/files/number_words.hpp"
#include "mapping/files/ply_header.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

void require_number(std::string_view word, std::size_t line) {
  if (!parsed_number(word))
    throw std::runtime_error("line " + std::to_string(line) + " has " + quote(word) + ", expected a number");
}

/// Calls `visit` with each line, its number from 1 behind it, until that says no.
void visit_lines(std::string_view text, const std::function<bool(std::string_view, std::size_t)>& visit) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (!visit(text.substr(0, end), number)) return;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

/// The numbers of a line; what follows '#' is a comment.
std::vector<double> numbers_in(std::string_view words, std::size_t line) {
  std::vector<double> numbers;
  for (std::string_view word = next_word(words); !word.empty() && word.front() != '#';
       word = next_word(words)) {
    require_number(word, line);
    numbers.push_back(*parsed_number(word));
  }
  return numbers;
}

/// "v x y z" of such a line, with a weight or a colour behind it, which are left out.
void add_vertex(std::string_view words, std::size_t line, std::string& plain) {
  std::vector<double> numbers = numbers_in(words, line);
  const bool has_weight = numbers.size() == 4 || numbers.size() == 7;
  if (numbers.size() != 3 && numbers.size() != 6 && !has_weight)
    throw std::runtime_error("line " + std::to_string(line) + " has a vertex of " +
                             std::to_string(numbers.size()) +
                             " numbers, expected 3, and a weight or a colour or nothing");
  if (has_weight && numbers[3] != 1.0)
    throw std::runtime_error("line " + std::to_string(line) + " has a vertex of another weight than 1");
  plain += 'v';
  for (std::size_t axis = 0; axis < 3; ++axis) plain += ' ' + to_text(numbers[axis]);
  plain += '\n';
}

/// A face, line or point: which vertices it has, without those of textures and normals.
void add_element(std::string_view kind, std::string_view words, std::string& plain) {
  plain += kind;
  for (std::string_view word = next_word(words); !word.empty() && word.front() != '#';
       word = next_word(words))
    plain.append(1, ' ').append(word.substr(0, word.find('/')));
  plain += '\n';
}

/// The numbers of an element in a line: as many as its properties say, and no more.
void check_ply_line(const PlyElement& element, std::string_view line, std::size_t number) {
  const std::vector<double> numbers = numbers_in(line, number);
  double expected = 0.0;
  for (const PlyProperty& property : element.properties) {
    const auto at = static_cast<std::size_t>(expected);
    expected += 1.0;
    if (property.count_bytes > 0 && at < numbers.size()) expected += std::max(numbers[at], 0.0);
    if (expected > static_cast<double>(numbers.size())) break;
  }
  if (expected != static_cast<double>(numbers.size()))
    throw std::runtime_error("line " + std::to_string(number) + " has " + std::to_string(numbers.size()) +
                             " numbers, other than its properties");
}

/// A line for each element, all of it numbers.
void check_ply_numbers(const std::string& content) {
  const PlyHeader header = ply_header(content);
  if (header.format != "ascii") return;
  auto element = header.elements.begin();
  std::uint64_t left = element == header.elements.end() ? 0 : element->count;
  visit_lines(content,
              [&, first = content.data() + header.length](std::string_view line, std::size_t number) {
                if (line.data() < first) return true;
                while (left == 0 && element != header.elements.end())
                  if (++element != header.elements.end()) left = element->count;
                if (element == header.elements.end()) return false;
                std::string_view rest = line;
                if (next_word(rest).empty()) return true;
                check_ply_line(*element, line, number);
                --left;
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
  if (kind == "ply") check_ply_numbers(content);
  if (kind == "stl") check_stl_numbers(content);
}

std::string plain_obj(const std::string& content) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  std::string plain, whole;
  std::string_view text = content;
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  visit_lines(text, [&](std::string_view line, std::size_t number) {
    whole.append(line.substr(0, line.find('#')));
    std::string_view words = whole;
    const std::string_view kind = next_word(words);
    const bool is_element = kind == "f" || kind == "l" || kind == "p";
    const std::size_t last = whole.find_last_not_of(" \t\r");
    if ((is_element || kind == "v") && whole[last] == '\\') {  // others may end so: "mtllib C:\\"
      whole.replace(last, std::string::npos, " ");
      return true;
    }
    if (kind == "v") add_vertex(words, number, plain);
    if (is_element) add_element(kind, words, plain);
    whole.clear();
    return true;
  });
  if (!whole.empty()) throw std::runtime_error("its last line goes on, and nothing follows");
  return plain;
}

std::vector<Eigen::Vector3d> vertices_of_obj(const std::string& plain) {
  std::vector<Eigen::Vector3d> vertices;
  visit_lines(plain, [&](std::string_view line, std::size_t) {
    if (next_word(line) != "v") return true;
    Eigen::Vector3d& vertex = vertices.emplace_back();
    for (int axis = 0; axis < 3; ++axis) vertex[axis] = parsed_number(next_word(line)).value_or(0.0);
    return true;
  });
  return vertices;
}

}  // namespace clearway
