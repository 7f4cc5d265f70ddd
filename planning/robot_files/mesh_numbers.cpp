#include "planning/robot_files/mesh_numbers.hpp"

#include <algorithm>
#include <array>
#include <bit>
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
  const auto ends_line = [](char c) { return c == '\n' || c == '\r'; };
  for (std::size_t number = 1; !text.empty(); ++number) {
    const auto end =
        static_cast<std::size_t>(std::find_if(text.begin(), text.end(), ends_line) - text.begin());
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
                             counted(numbers.size(), "number") +
                             ", expected 3, and a weight or a colour or nothing");
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
    throw std::runtime_error("line " + std::to_string(number) + " has " + counted(numbers.size(), "number") +
                             ", other than its properties");
}

/// The numbers of a .ply file's data, one after the other. Of whole ones in binary data the sign is not
/// known.
class PlyNumbers {
 public:
  PlyNumbers(std::string_view data, const std::string& format)
      : data_(data), is_text_(format == "ascii"), is_big_(format == "binary_big_endian") {}

  double take(std::uint64_t bytes, bool is_real) {
    if (is_text_) return parsed_number(next_word(data_)).value_or(0.0);
    if (bytes > data_.size()) throw std::runtime_error("it holds fewer elements than its header says");
    std::uint64_t bits = 0;
    for (std::uint64_t i = 0; i < bytes; ++i)
      bits |= std::uint64_t{static_cast<unsigned char>(data_[i])} << 8U * (is_big_ ? bytes - 1 - i : i);
    data_.remove_prefix(bytes);
    if (!is_real) return static_cast<double>(bits);
    return bytes == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                      : std::bit_cast<double>(bits);
  }

  bool is_text() const { return is_text_; }

 private:
  std::string_view data_;
  bool is_text_, is_big_;
};

/// Vertices and faces of a .ply.
class PlainPly {
 public:
  explicit PlainPly(std::uint64_t vertices) : is_used_(vertices) {}

  /// Takes the numbers of one element.
  void add(const PlyElement& element, PlyNumbers& numbers) {
    std::array<double, 3> vertex{};
    if (element.name != "vertex" && element.name != "face" && element.name != "tristrips")
      may_have_other_faces_ = true;
    for (const PlyProperty& property : element.properties) {
      if (property.count_bytes == 0) {
        const double number = numbers.take(property.bytes, property.is_real);
        const std::size_t axis = std::string_view("xyz").find(property.name);
        if (property.name.size() == 1 && axis < vertex.size()) vertex[axis] = number;
        continue;
      }
      std::vector<double> list(static_cast<std::size_t>(numbers.take(property.count_bytes, false)));
      for (double& number : list) number = numbers.take(property.bytes, property.is_real);
      add_list(element.name, property, list);
    }
    if (element.name == "vertex") vertices_.push_back(vertex);
  }

  /// As a text, without vertices that no face has, if those of all faces are known.
  std::string text() const {
    const bool leaves_out = faces_ > 0 && !may_have_other_faces_;
    std::vector<std::uint64_t> place;
    std::uint64_t count = 0;
    std::string vertex_lines, face_lines;
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      place.push_back(count);
      if (leaves_out && !is_used_[i]) continue;
      for (const double number : vertices_[i]) vertex_lines += to_text(number) + ' ';
      vertex_lines += '\n';
      ++count;
    }
    for (std::size_t at = 0; at < corners_.size(); at += corners_[at] + 1) {
      face_lines += std::to_string(corners_[at]);
      for (std::size_t i = 1; i <= corners_[at]; ++i)
        face_lines += ' ' + std::to_string(place[static_cast<std::size_t>(corners_[at + i])]);
      face_lines += '\n';
    }
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
           std::to_string(faces_) + "\nproperty list uint uint vertex_indices\nend_header\n" + vertex_lines +
           face_lines;
  }

 private:
  /// Lists of whole numbers by other names may be faces, too; real ones are textures.
  void add_list(const std::string& element, const PlyProperty& property, const std::vector<double>& list) {
    const bool is_indices = property.name == "vertex_indices" || property.name == "vertex_index";
    if (element == "face" && is_indices) return add_face(list);
    if (element == "tristrips" && is_indices) return add_strips(list);
    may_have_other_faces_ = may_have_other_faces_ || !property.is_real;
  }
  void add_face(const std::vector<double>& corners) {
    if (corners.empty()) return;
    corners_.push_back(corners.size());
    for (const double corner : corners) {
      if (!(corner >= 0.0 && corner < static_cast<double>(is_used_.size())))
        throw std::runtime_error("a face names a vertex that is not there");
      corners_.push_back(static_cast<std::uint64_t>(corner));
      is_used_[static_cast<std::size_t>(corner)] = true;
    }
    ++faces_;
  }
  /// Strips that end with -1, of triangles of three corners in a row.
  void add_strips(const std::vector<double>& corners) {
    const auto ends = [](double corner) { return corner < 0.0 || corner == 4294967295.0; };
    for (std::size_t i = 0; i + 2 < corners.size(); ++i)
      if (!ends(corners[i]) && !ends(corners[i + 1]) && !ends(corners[i + 2]))
        add_face({corners[i], corners[i + 1], corners[i + 2]});
  }

  std::vector<bool> is_used_;  ///< of each vertex: a face has it
  std::vector<std::array<double, 3>> vertices_;
  std::vector<std::uint64_t> corners_;  ///< of each face how many it has, and their vertices
  std::uint64_t faces_ = 0;
  bool may_have_other_faces_ = false;
};

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

std::string plain_ply(const std::string& content) {
  const PlyHeader header = ply_header(content);
  const PlyElement& vertices = ply_vertices(header);
  const bool is_known = header.format == "ascii" || header.format == "binary_little_endian" ||
                        header.format == "binary_big_endian";
  if (!is_known)
    throw std::runtime_error("its format is " + quote(header.format) +
                             ", expected ascii, binary_little_endian or binary_big_endian");
  PlyNumbers numbers(std::string_view(content).substr(header.length), header.format);
  for (const PlyProperty& property : vertices.properties)
    if (!numbers.is_text() && !property.is_real && std::string_view("xyz").find(property.name) < 3)
      throw std::runtime_error("its vertices have " + quote(property.name) +
                               " as a whole number, expected float or double");
  PlainPly plain(vertices.count);
  for (const PlyElement& element : header.elements)
    for (std::uint64_t i = 0; i < element.count; ++i) plain.add(element, numbers);
  return plain.text();
}

std::vector<Eigen::Vector3d> vertices_of_ply(const std::string& plain) {
  const PlyHeader header = ply_header(plain);
  std::string_view data = std::string_view(plain).substr(header.length);
  std::vector<Eigen::Vector3d> vertices(ply_vertices(header).count);
  for (Eigen::Vector3d& vertex : vertices)
    for (double& number : vertex) number = parsed_number(next_word(data)).value_or(0.0);
  return vertices;
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
