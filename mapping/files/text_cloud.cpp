#include "mapping/files/text_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <locale>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/files/number_words.hpp"
#include "mapping/files/ply_header.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// No header is longer.
constexpr std::size_t megabyte = std::size_t{1} << 20U, most_header_bytes = megabyte;

/// The number that a whole word is, one that a float can hold.
std::optional<double> float_number(std::string_view word) {
  const std::optional<double> number = parsed_number(word);
  if (number && std::isfinite(*number) && std::abs(*number) > std::numeric_limits<float>::max())
    return std::nullopt;
  return number;
}

/// Lines of a text, counted from 1.
class CountedLines {
 public:
  explicit CountedLines(std::string_view text, std::size_t before = 0) : text_(text), count_(before) {}
  bool is_at_end() const { return text_.empty(); }
  std::string_view rest() const { return text_; }
  std::string_view next() {
    const std::size_t end = std::min(text_.find('\n'), text_.size());
    const std::string_view line = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++count_;
    return line;
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw std::runtime_error("line " + std::to_string(count_) + " " + why);
  }
  /// The number at the beginning of what is left of a line.
  double take_number(std::string_view& line) const {
    const std::string_view word = next_word(line);
    if (word.empty()) refuse("has too few numbers");
    const std::optional<double> number = float_number(word);
    if (!number) refuse("has " + quote(word) + ", expected a number");
    return *number;
  }
  void require_end(std::string_view line) const {
    if (!next_word(line).empty()) refuse("has too many numbers");
  }

 private:
  std::string_view text_;
  std::size_t count_ = 0;
};

[[noreturn]] void refuse_count() {
  throw std::runtime_error("it holds another count of points than its header says");
}

struct PcdHeader {
  std::size_t points = 0, columns = 0;
  std::vector<std::size_t> sizes{}, counts{};  ///< of each field: bytes of a number, numbers; counts may lack
  std::string kind;
  std::size_t length = 0, lines = 0;
};

std::vector<std::size_t> numbers_of(std::istream& words) {
  std::vector<std::size_t> numbers;
  for (std::size_t number = 0; words >> number;) numbers.push_back(number);
  return numbers;
}

std::size_t count_words(std::istream& words) {
  std::size_t count = 0;
  for (std::string word; words >> word;) ++count;
  return count;
}

/// PCL would take what comes before the first letter that is wrong.
void check_viewpoint(const CountedLines& lines, std::string_view line) {
  next_word(line);
  for (int i = 0; i < 7; ++i) lines.take_number(line);
  lines.require_end(line);
}

PcdHeader pcd_header(std::string_view content) {
  PcdHeader header;
  CountedLines lines(content);
  while (header.kind.empty() && !lines.is_at_end()) {
    const std::string_view line = lines.next();
    std::istringstream words{std::string(line)};
    words.imbue(std::locale::classic());
    std::string key;
    words >> key;
    if (key == "POINTS") words >> header.points;
    if (key == "FIELDS" && header.columns == 0) header.columns = count_words(words);
    if (key == "SIZE") header.sizes = numbers_of(words);
    if (key == "COUNT") {
      header.counts = numbers_of(words);
      header.columns = std::accumulate(header.counts.begin(), header.counts.end(), std::size_t{0});
    }
    if (key == "VIEWPOINT") check_viewpoint(lines, line);
    if (key == "DATA") words >> header.kind;
    header.length += line.size() + 1;
    ++header.lines;
  }
  if (header.kind != "ascii" && header.kind != "binary" && header.kind != "binary_compressed")
    throw std::runtime_error("its header is cut off or names no known kind of data");
  header.length = std::min(header.length, content.size());
  return header;
}

/// A line for each point, and empty ones.
void check_pcd_text(const PcdHeader& header, std::string_view content) {
  CountedLines lines(content.substr(header.length), header.lines);
  std::size_t points = 0;
  while (!lines.is_at_end()) {
    std::string_view line = lines.next();
    if (line.empty()) continue;
    if (points == header.points && next_word(line).empty()) continue;
    if (++points > header.points) refuse_count();
    for (std::size_t i = 0; i < header.columns; ++i) lines.take_number(line);
    lines.require_end(line);
  }
  if (points != header.points) refuse_count();
}

/// Bytes of binary data, where the header says so. @param data the beginning of it
std::optional<std::size_t> pcd_bytes(const PcdHeader& header, std::string_view data) {
  std::uint32_t compressed = 0;
  if (header.kind == "binary_compressed") {
    if (data.size() < 2 * sizeof(compressed)) return std::nullopt;
    std::memcpy(&compressed, data.data(), sizeof(compressed));
    return 2 * sizeof(compressed) + compressed;
  }
  std::size_t of_point = 0;
  for (std::size_t i = 0; i < header.sizes.size(); ++i)
    of_point += header.sizes[i] * (i < header.counts.size() ? header.counts[i] : 1);
  if (header.points > std::numeric_limits<std::uint32_t>::max() || of_point > megabyte) return std::nullopt;
  return header.points * of_point;
}

/// Nothing behind the points of binary data; that they are all there, PCL sees.
void check_pcd_end(const PcdHeader& header, const InputFile& input, std::string& content) {
  const auto bytes = pcd_bytes(header, std::string_view(content).substr(header.length));
  if (!bytes || header.length + *bytes >= input.size()) return;
  for (std::size_t at = header.length + *bytes; at < input.size(); at += megabyte) {
    input.read_at(at, std::min(megabyte, input.size() - at), content);
    require_nothing_more(content);
  }
}

void check_ply_line(const CountedLines& lines, std::string_view line, const PlyElement& element) {
  for (const PlyProperty& property : element.properties) {
    double count = lines.take_number(line);
    if (property.count_bytes == 0) continue;
    if (!(count >= 0.0 && count == std::floor(count))) lines.refuse("has a list of a wrong length");
    for (; count > 0.0; --count) lines.take_number(line);
  }
  lines.require_end(line);
}

/// A line for each element.
void check_ply_text(const PlyHeader& header, std::string_view content) {
  const auto before = std::count(content.begin(), content.begin() + std::ptrdiff_t(header.length), '\n');
  CountedLines lines(content.substr(header.length), static_cast<std::size_t>(before));
  for (const PlyElement& element : header.elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (lines.is_at_end()) throw std::runtime_error("it holds fewer elements than its header says");
      check_ply_line(lines, lines.next(), element);
    }
  }
  require_nothing_more(lines.rest());
}

}  // namespace

void check_data_of_cloud(const std::filesystem::path& file, bool is_pcd) {
  const InputFile input(file, "cloud");
  std::string content;
  input.read_at(0, std::min(input.size(), most_header_bytes), content);
  const auto read_all = [&] { input.read_at(0, input.size(), content); };
  if (is_pcd) {
    const PcdHeader header = pcd_header(content);
    if (header.kind != "ascii") return check_pcd_end(header, input, content);
    read_all();
    check_pcd_text(header, content);
  } else {
    const PlyHeader header = ply_header(content);
    ply_vertices(header);
    read_all();
    if (header.format == "ascii") return check_ply_text(header, content);
    const std::string_view data = std::string_view(content).substr(header.length);
    require_nothing_more(data.substr(bytes_of_elements(header, data)));
  }
}

}  // namespace clearway
