#include "mapping/files/ply_header.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
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

constexpr std::array<const char*, 12> camera_keys{"view_px", "view_py", "view_pz", "x_axisx",
                                                  "x_axisy", "x_axisz", "y_axisx", "y_axisy",
                                                  "y_axisz", "z_axisx", "z_axisy", "z_axisz"};

/// A number of binary data, as the file orders its bytes.
template <typename Number>
Number number_at(std::string_view bytes, bool is_big) {
  std::array<char, sizeof(Number)> raw{};
  std::copy_n(bytes.begin(), raw.size(), raw.begin());
  if (is_big == (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.end());
  Number number;
  std::memcpy(&number, raw.data(), sizeof(Number));
  return number;
}

std::uint64_t count_at(std::string_view bytes, std::uint64_t size, bool is_big) {
  if (size == 1) return static_cast<unsigned char>(bytes.front());
  return size == 2 ? number_at<std::uint16_t>(bytes, is_big) : number_at<std::uint32_t>(bytes, is_big);
}

/// Goes through the data of a .ply file, element by element.
class PlyData {
 public:
  PlyData(std::string_view data, const std::string& format)
      : data_(data), is_text_(format == "ascii"), is_big_(format == "binary_big_endian") {}

  void skip(const PlyElement& element) {
    std::uint64_t width = 0;
    bool has_lists = false;
    for (const PlyProperty& property : element.properties) {
      has_lists |= property.count_bytes > 0;
      width += property.bytes;
    }
    if (is_text_ || has_lists)
      for (std::uint64_t i = 0; i < element.count; ++i) read(element, [](const PlyProperty&, double) {});
    else if (width > 0 && element.count > data_.size() / width)
      refuse_data();
    else
      take(element.count * width);
  }

  std::string_view rest() const { return data_; }

  /// @param use is called with each property that is no list and its bytes, in a text file its word
  template <class Use>
  void visit(const PlyElement& element, const Use& use) {
    std::string_view line = is_text_ ? take_line() : std::string_view();
    for (const PlyProperty& property : element.properties) {
      const std::string_view first = is_text_ ? take_word(line) : std::string_view();
      if (property.count_bytes == 0) {
        use(property, is_text_ ? first : take(property.bytes));
      } else if (!is_text_) {
        const std::uint64_t count = count_at(take(property.count_bytes), property.count_bytes, is_big_);
        take(count * property.bytes);
      } else {
        std::uint64_t count = 0;
        std::from_chars(first.data(), first.data() + first.size(), count);
        for (; count > 0 && !line.empty(); --count) take_word(line);
        if (count > 0) refuse_data();
      }
    }
  }

  /// @param use is called with each real number that is no list
  template <class Use>
  void read(const PlyElement& element, const Use& use) {
    if (is_text_) return read_line(element, use);
    for (const PlyProperty& property : element.properties) {
      std::uint64_t count = 1;
      if (property.count_bytes > 0)
        count = count_at(take(property.count_bytes), property.count_bytes, is_big_);
      const std::string_view bytes = take(count * property.bytes);
      if (property.count_bytes > 0 || !property.is_real) continue;
      use(property, property.bytes == sizeof(float) ? static_cast<double>(number_at<float>(bytes, is_big_))
                                                    : number_at<double>(bytes, is_big_));
    }
  }

 private:
  [[noreturn]] static void refuse_data() { throw std::runtime_error("its points cannot be read"); }

  std::string_view take(std::uint64_t bytes) {
    if (bytes > data_.size()) refuse_data();
    const std::string_view taken = data_.substr(0, bytes);
    data_.remove_prefix(bytes);
    return taken;
  }

  std::string_view take_line() {
    if (data_.empty()) refuse_data();
    const std::size_t end = std::min(data_.find('\n'), data_.size());
    const std::string_view line = take(end);
    take(std::min<std::size_t>(1, data_.size()));
    return line;
  }

  static std::string_view take_word(std::string_view& line) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
    line.remove_prefix(word.size());
    return word;
  }

  template <class Use>
  void read_line(const PlyElement& element, const Use& use) {
    std::string_view line = take_line();
    for (const PlyProperty& property : element.properties) {
      if (property.count_bytes > 0) return;  // what follows a list is not looked for
      const std::string_view word = take_word(line);
      double number = 0.0;
      if (std::from_chars(word.data(), word.data() + word.size(), number).ec == std::errc() &&
          property.is_real)
        use(property, number);
    }
  }

  std::string_view data_;
  bool is_text_, is_big_;
};

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
    if (key == "comment" && word == "PCL") header.is_of_pcl = true;
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
    property.is_real = word.starts_with("float") || word == "double";
    line >> property.name;
    header.elements.back().properties.push_back(property);
  }
}

const PlyElement& ply_vertices(const PlyHeader& header) {
  const auto is_vertices = [](const PlyElement& element) { return element.name == "vertex"; };
  const auto found = std::find_if(header.elements.begin(), header.elements.end(), is_vertices);
  if (std::count_if(header.elements.begin(), header.elements.end(), is_vertices) != 1)
    throw std::runtime_error("its header has " +
                             std::string(found == header.elements.end() ? "no" : "several") +
                             " 'element vertex', expected one");
  for (const char* axis : {"x", "y", "z"}) {
    const auto count = std::count_if(
        found->properties.begin(), found->properties.end(),
        [&](const PlyProperty& property) { return property.name == axis && property.count_bytes == 0; });
    if (count != 1)
      throw std::runtime_error("its vertices have " + std::string(count == 0 ? "no" : "several") +
                               " 'property " + axis + "', expected one");
  }
  return *found;
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

bool has_scan_grid(const PlyHeader& header, std::string_view content) {
  return content.substr(0, header.length).find("\nobj_info") != std::string_view::npos ||
         std::any_of(header.elements.begin(), header.elements.end(),
                     [](const PlyElement& element) { return element.name == "range_grid"; });
}

std::string as_pcl_reads_rightly(std::string_view content) {
  const PlyHeader header = ply_header(content);
  const bool has_odd = has_odd_colours(header);
  std::string text;
  for (std::size_t at = 0; at < header.length;) {
    const std::size_t end = content.find('\n', at) + 1;
    std::string line(content.substr(at, end - at));
    PlyProperty property;
    std::istringstream words(line);
    std::string key, type;
    words >> key >> type >> property.name;
    if (key == "property" && type != "list" && has_odd && !colour_of(property).empty())
      line = "property " + type + " unread_" + std::to_string(at) + "\n";
    if (key == "obj_info") line = "comment of a scanner\n";
    if (key == "element" && type == "range_grid") line = "element unread_grid " + property.name + "\n";
    text += line;
    at = end;
  }
  return text.append(content.substr(header.length));
}

bool has_vertex_lists(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(), [](const PlyElement& element) {
    return element.name == "vertex" &&
           std::any_of(element.properties.begin(), element.properties.end(),
                       [](const PlyProperty& property) { return property.count_bytes > 0; });
  });
}

std::string without_vertex_lists(std::string_view content) {
  const PlyHeader header = ply_header(content);
  const auto is_place = [](const std::string& name) { return name == "x" || name == "y" || name == "z"; };
  std::string text, element;
  for (std::size_t at = 0; at < header.length;) {
    const std::size_t end = content.find('\n', at) + 1;
    const std::string line(content.substr(at, end - at));
    at = end;
    std::istringstream words(line);
    std::string key, type, name;
    words >> key >> type >> name;
    if (key == "element") element = type;
    if (key == "property" && element == "vertex" && (type == "list" || !is_place(name))) continue;
    text += line;
  }
  const bool is_text = header.format == "ascii";
  PlyData data(content.substr(header.length), header.format);
  for (const PlyElement& part : header.elements) {
    const std::string_view before = data.rest();
    if (part.name != "vertex") {
      data.skip(part);
      text += before.substr(0, before.size() - data.rest().size());
      continue;
    }
    for (std::uint64_t i = 0; i < part.count; ++i) {
      data.visit(part, [&](const PlyProperty& property, std::string_view bytes) {
        if (is_place(property.name)) text.append(bytes).append(is_text ? " " : "");
      });
      if (is_text) text += '\n';
    }
  }
  return text.append(data.rest());
}

std::optional<PlyCamera> ply_camera(std::string_view content) {
  const PlyHeader header = ply_header(content);
  const auto camera =
      std::find_if(header.elements.begin(), header.elements.end(),
                   [](const PlyElement& element) { return element.name == "camera" && element.count > 0; });
  if (camera == header.elements.end()) return std::nullopt;
  PlyData data(content.substr(header.length), header.format);
  for (auto element = header.elements.begin(); element != camera; ++element) data.skip(*element);
  std::array<float, camera_keys.size()> values{};
  std::size_t found = 0;
  data.read(*camera, [&](const PlyProperty& property, double value) {
    const auto* key = std::find(camera_keys.begin(), camera_keys.end(), property.name);
    if (key == camera_keys.end()) return;
    values[static_cast<std::size_t>(key - camera_keys.begin())] = static_cast<float>(value);
    ++found;
  });
  if (found != camera_keys.size()) return std::nullopt;
  PlyCamera result;
  result.origin = Eigen::Vector3f(values[0], values[1], values[2]);
  const Eigen::Map<const Eigen::Matrix3f> axes(&values[3]);  // each axis is a column
  result.turn = axes;
  if (header.is_of_pcl) result.turn.transposeInPlace();
  return result;
}

}  // namespace clearway
