#include "mapping/files/painted_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "mapping/files/map_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

constexpr std::string_view old_column_names = "volume,label,critical_parts,x,y,z,radius,time";
constexpr std::string_view stroke_column_names = "stroke,stroke_label,source";
std::string column_names() { return std::string(old_column_names) + ',' + std::string(stroke_column_names); }
using Row = std::vector<std::string>;

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

std::string join_parts(const std::vector<std::string>& parts) {
  std::string result;
  for (const std::string& part : parts) {
    if (&part != &parts.front()) result += ';';
    for (char c : part) {
      if (c == ';' || c == '\\') result += '\\';
      result += c;
    }
  }
  return result;
}

std::vector<std::string> split_parts(std::string_view text) {
  std::vector<std::string> parts;
  if (text.empty()) return parts;
  parts.emplace_back();
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == ';') {
      parts.emplace_back();
    } else {
      if (text[i] == '\\' && i + 1 < text.size()) ++i;
      parts.back() += text[i];
    }
  }
  std::erase(parts, "");  // "hand;" is "hand"
  return parts;
}

/// Takes one line off `text`; quotes may hold commas and doubled quotes, never a line end.
class Reader {
 public:
  Reader(std::string_view text, const std::filesystem::path& file) : text_(text), file_(file) {}

  bool at_end() const { return text_.empty(); }

  [[noreturn]] void refuse(const std::string& expected) const {
    throw DamagedFile("'" + file_.string() + "' line " + std::to_string(line_) + ": expected " + expected);
  }

  std::string_view take_line() {
    ++line_;
    const auto end = text_.find('\n');
    if (end == std::string_view::npos) refuse("a line end: the file is cut off");
    std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);  // of an editor or a spreadsheet
    return line;
  }

  /// The line with the names of the columns: all of them, or those that there were before strokes.
  void take_head() {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
    const std::string_view line = take_line();
    if (line != column_names() && line != old_column_names)
      refuse("the columns " + std::string(old_column_names) + ", and " + std::string(stroke_column_names) +
             " behind them or none of these");
    columns_ = 1 + static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
  }

  /// One line; the columns that an old file lacks are empty.
  Row take_row() {
    std::string_view line = take_line();
    Row row(1);
    bool inside_quotes = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (inside_quotes && line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"') {
        row.back() += line[i++];
      } else if (line[i] == '"') {
        inside_quotes = !inside_quotes;
      } else if (line[i] == ',' && !inside_quotes) {
        row.emplace_back();
      } else {
        row.back() += line[i];
      }
    }
    if (inside_quotes) refuse("quotes that end on the line where they begin");
    if (row.size() != columns_)
      refuse(counted(columns_, "value") + ", one for each column, found " + std::to_string(row.size()));
    row.resize(all_columns);
    return row;
  }

  double finite(const std::string& text, const char* column) const {
    double value = 0.0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !std::isfinite(value)) {
      refuse(std::string("a finite number for ") + column + ", found " + quote(text));
    }
    return value;
  }

 private:
  static constexpr std::size_t all_columns = 11;
  std::string_view text_;
  const std::filesystem::path& file_;
  int line_ = 0;
  std::size_t columns_ = 0;
};

/// The volume of a row; volumes appear in order, and a repeated one repeats its label and parts.
PaintedVolume& volume_of(const Row& row, std::vector<PaintedVolume>& volumes, const Reader& reader) {
  const double index = reader.finite(row[0], "volume");
  if (index == static_cast<double>(volumes.size()) && index < FusedTree::volume_limit) {
    const auto is_label = [&](const PaintedVolume& volume) { return volume.label == row[1]; };
    if (std::any_of(volumes.begin(), volumes.end(), is_label))
      reader.refuse("a label of its own for each volume");
    if (!is_storable_name(row[1]) || !is_storable_name(row[2]))
      reader.refuse("names without control characters");
    volumes.push_back({row[1], split_parts(row[2])});
  } else if (volumes.empty() || index != static_cast<double>(volumes.size() - 1)) {
    reader.refuse("volumes numbered 0, 1, 2 ... 14 in order");
  }
  if (volumes.back().label != row[1] || volumes.back().critical_parts != split_parts(row[2])) {
    reader.refuse("the same label and critical parts on every line of a volume");
  }
  return volumes.back();
}

/// The stroke of a row, -1 for none; strokes appear in order, and a repeated one repeats its names.
int stroke_of(const Row& row, PaintedVolume& volume, const Reader& reader) {
  if (row[8].empty()) return -1;
  const double index = reader.finite(row[8], "stroke");
  if (index == static_cast<double>(volume.strokes.size())) {
    if (!is_storable_name(row[9]) || !is_storable_name(row[10]))
      reader.refuse("names without control characters");
    volume.strokes.push_back({row[9], row[10]});
  }
  const bool known = index >= 0.0 && index < static_cast<double>(volume.strokes.size());
  if (!known || index != std::floor(index)) reader.refuse("strokes numbered 0, 1, 2 ... in order");
  const auto stroke = static_cast<std::size_t>(index);
  if (volume.strokes[stroke].label != row[9] || volume.strokes[stroke].source != row[10]) {
    reader.refuse("the same label and source on every line of a stroke");
  }
  return static_cast<int>(stroke);
}

/// Strokes in the order in which their spheres appear, which is the order that stroke_of expects.
class StrokeNumbers {
 public:
  int number(int stroke) {
    return numbers_.try_emplace(stroke, static_cast<int>(numbers_.size())).first->second;
  }

 private:
  std::map<int, int> numbers_;
};

std::string stroke_columns(const PaintedVolume& volume, std::size_t sphere, StrokeNumbers& numbers) {
  const Stroke* stroke = volume.stroke(sphere);
  if (stroke == nullptr) return ",,,";
  if (!is_storable_name(stroke->label) || !is_storable_name(stroke->source)) {
    throw std::invalid_argument("stroke " + quote(stroke->label) +
                                ": expected names without control characters");
  }
  return "," + std::to_string(numbers.number(volume.stroke_of[sphere])) + "," + in_quotes(stroke->label) +
         "," + in_quotes(stroke->source);
}

}  // namespace

std::string format_painted(const std::vector<PaintedVolume>& volumes) {
  std::string text(column_names());
  text += '\n';
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    const PaintedVolume& volume = volumes[v];
    if (!is_storable_name(volume.label + join_parts(volume.critical_parts))) {
      throw std::invalid_argument("painted volume " + quote(volume.label) +
                                  ": expected names without control characters");
    }
    const std::string start = std::to_string(v) + "," + in_quotes(volume.label) + "," +
                              in_quotes(join_parts(volume.critical_parts)) + ",";
    if (volume.spheres.empty()) text += start + ",,,,,,,\n";
    StrokeNumbers numbers;
    for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
      const Sphere& sphere = volume.spheres[i];
      const double time = i < volume.times.size() ? volume.times[i] : 0.0;
      text += start;
      for (double value : {sphere.center.x(), sphere.center.y(), sphere.center.z(), sphere.radius})
        text += to_text(value) + ",";
      text += to_text(time) + stroke_columns(volume, i, numbers) + "\n";
    }
  }
  return text;
}

std::vector<PaintedVolume> parse_painted(std::string_view text, const std::filesystem::path& file) {
  Reader reader(text, file);
  std::vector<PaintedVolume> volumes;
  reader.take_head();
  while (!reader.at_end()) {
    const Row row = reader.take_row();
    PaintedVolume& volume = volume_of(row, volumes, reader);
    if (std::all_of(row.begin() + 3, row.end(), [](const std::string& field) { return field.empty(); }))
      continue;
    const Sphere sphere{{reader.finite(row[3], "x"), reader.finite(row[4], "y"), reader.finite(row[5], "z")},
                        reader.finite(row[6], "radius")};
    if (!(sphere.radius > 0.0)) reader.refuse("a radius > 0");
    volume.add(sphere, reader.finite(row[7], "time"), stroke_of(row, volume, reader));
  }
  return volumes;
}

void require_paintable(const std::vector<PaintedVolume>& volumes, double resolution,
                       const std::filesystem::path& file) {
  const double largest = largest_painted(resolution);
  for (const PaintedVolume& volume : volumes)
    for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
      const double radius = volume.spheres[i].radius;
      if (radius <= largest) continue;
      throw std::invalid_argument("'" + file.string() + "': sphere " + std::to_string(i + 1) + " of volume " +
                                  quote(volume.label) + " has a radius of " + short_text(radius) +
                                  " m, expected at most " + short_text(largest) +
                                  " m, 1000 voxels of this map");
    }
}

}  // namespace clearway
