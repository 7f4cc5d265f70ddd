#include "planning/robot_files/mesh_numbers.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "mapping/files/number_words.hpp"
#include "mapping/files/ply_header.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/whole_mesh.hpp"

namespace clearway {
namespace {

void require_number(std::string_view word, std::size_t line) {
  if (!parsed_number(word))
    throw std::runtime_error("line " + std::to_string(line) + " has " + quote(word) + ", expected a number");
}

/// Calls `visit` with each line, its number from 1 behind it, until that says no.
void visit_lines(std::string_view text, const std::function<bool(std::string_view, std::size_t)>& visit) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    if (!visit(text.substr(0, end), number)) return;
    text.remove_prefix(end);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min(text.size(), std::size_t{1}));
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

/// Refuses what may be a vertex or an element by another name: left out, the body would be smaller.
void require_obj_word(std::string_view kind, std::size_t line) {
  constexpr std::array<std::string_view, 7> known{"v", "vt", "vn", "vp", "f", "l", "p"};
  if (kind.empty() || std::find(known.begin(), known.end(), kind) != known.end()) return;
  if (kind == "call")
    throw std::runtime_error("line " + std::to_string(line) + " calls another file, which is not read");
  const auto first = static_cast<char>(std::tolower(static_cast<unsigned char>(kind.front())));
  const bool is_short = kind.size() == 1 || std::isalpha(static_cast<unsigned char>(kind[1])) == 0;
  if (first == 'v' || (is_short && (first == 'f' || first == 'l' || first == 'p')))
    throw std::runtime_error("line " + std::to_string(line) + " has " + quote(kind) +
                             ", expected 'v', 'vt', 'vn', 'vp', 'f', 'l', 'p' or another word of an .obj");
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

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  return text;
}

/// Letters of either case.
bool is_keyword(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

/// The words of a text .stl, wherever its lines end.
class StlText {
 public:
  void add_line(std::string_view words, std::size_t line) {
    for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
      if (is_keyword(word, "solid") || is_keyword(word, "endsolid")) {
        close_facet(line);
        is_open_ = is_keyword(word, "solid");
        return;  // its name is behind it
      }
      add_word(word, words, line);
    }
  }
  std::string take() {
    if (is_open_ || corners_ != none) throw std::runtime_error("it has no 'endsolid': its end is missing");
    return "solid mesh\n" + std::move(facets_) + "endsolid mesh\n";
  }

 private:
  void add_word(std::string_view word, std::string_view& words, std::size_t line) {
    if (is_keyword(word, "normal")) {
      for (int axis = 0; axis < 3; ++axis) next_word(words);
    } else if (is_keyword(word, "facet")) {
      close_facet(line);
      is_open_ = true;
      corners_ = 0;
      facets_ += "facet normal 0 0 0\nouter loop\n";
    } else if (is_keyword(word, "endfacet")) {
      close_facet(line);
    } else if (is_keyword(word, "vertex")) {
      add_vertex(words, line);
    } else if (!is_keyword(word, "outer") && !is_keyword(word, "loop") && !is_keyword(word, "endloop")) {
      throw std::runtime_error("line " + std::to_string(line) + " has " + quote(word) +
                               ", expected a word of a text .stl");
    }
  }
  void add_vertex(std::string_view& words, std::size_t line) {
    if (corners_ == none)
      throw std::runtime_error("line " + std::to_string(line) + " has a vertex outside of a facet");
    ++corners_;
    facets_ += "vertex";
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = next_word(words);
      require_number(word, line);
      facets_.append(1, ' ').append(to_text(*parsed_number(word)));
    }
    facets_ += '\n';
  }
  void close_facet(std::size_t line) {
    if (corners_ == none) return;
    if (corners_ != 3)
      throw std::runtime_error("line " + std::to_string(line) + " ends a facet of " +
                               std::to_string(corners_) + " vertices, expected 3");
    corners_ = none;
    facets_ += "endloop\nendfacet\n";
  }

  static constexpr int none = -1;
  std::string facets_;
  int corners_ = none;  // of the facet that is open
  bool is_open_ = false;
};

}  // namespace

void check_numbers_of_ply(const std::string& content) {
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

std::string plain_stl(const std::string& content) {
  if (const std::size_t bytes = binary_stl_bytes(content); bytes > 0) return content.substr(0, bytes);
  if (content.find('\0') != std::string::npos)
    throw std::runtime_error("its header counts other facets than it holds");
  std::string_view text = without_byte_order_mark(content), begin = text;
  if (!is_keyword(next_word(begin), "solid"))
    throw std::runtime_error("it is neither a binary .stl nor a text that begins with 'solid'");
  StlText facets;
  visit_lines(text, [&](std::string_view line, std::size_t number) {
    facets.add_line(line, number);
    return true;
  });
  return facets.take();
}

std::string plain_obj(const std::string& content) {
  std::string plain, whole;
  visit_lines(without_byte_order_mark(content), [&](std::string_view line, std::size_t number) {
    whole.append(line.substr(0, line.find('#')));
    const std::size_t last = whole.find_last_not_of(" \t\r");
    const bool goes_on = last != std::string::npos && whole[last] == '\\';
    std::string_view words = std::string_view(whole).substr(0, goes_on ? last : whole.size());
    const std::string_view kind = next_word(words);
    const bool is_element = kind == "f" || kind == "l" || kind == "p";
    if (goes_on && (is_element || kind == "v" || kind.empty())) {  // others may end so: "mtllib C:\\"
      whole.replace(last, std::string::npos, " ");
      return true;
    }
    require_obj_word(kind, number);
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
