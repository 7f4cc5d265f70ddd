#include "mapping/files/xyz_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "mapping/files/number_words.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t largest_text = std::size_t{4} << 30U;
constexpr double most_points = 1e12;  ///< that a first line may state
constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Whether a line says something about the file; `line` is then what it says.
bool take_comment(std::string_view& line) {
  for (const std::string_view mark : {"#", "//"}) {
    if (!line.starts_with(mark)) continue;
    line = trimmed(line.substr(mark.size()));
    return true;
  }
  return false;
}

/// What parts the columns of a line: ' ' stands for any blanks.
char delimiter_of(std::string_view line) {
  for (const char delimiter : {';', ','})
    if (line.find(delimiter) != std::string_view::npos) return delimiter;
  return ' ';
}

/// Takes the next column off a line.
std::string_view next_column(std::string_view& line, char delimiter) {
  if (delimiter == ' ') return next_word(line);
  const std::size_t end = std::min(line.find(delimiter), line.size());
  const std::string_view column = trimmed(line.substr(0, end));
  line.remove_prefix(std::min(end + 1, line.size()));
  return column;
}

std::vector<std::string> columns_of(std::string_view line) {
  const char delimiter = delimiter_of(line);
  std::vector<std::string> columns;
  for (line = trimmed(line); !line.empty();) {
    std::string name(next_column(line, delimiter));
    std::erase(name, '"');
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    columns.push_back(std::move(name));
  }
  return columns;
}

using Places = std::array<std::size_t, 3>;

/// Where a head has x, y and z; empty when it does not name each once.
std::optional<Places> places_of(const std::vector<std::string>& names) {
  Places places{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    if (std::count(names.begin(), names.end(), name) != 1) return std::nullopt;
    places[axis] = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  return places;
}

class XyzReader {
 public:
  explicit XyzReader(const std::filesystem::path& file) : file_(file) {}

  std::vector<Eigen::Vector3f> read() {
    const std::string text = read_input(file_, "cloud", largest_text);
    std::string_view rest = text;
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      ++line_;
      take_line(trimmed(rest.substr(0, end)));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (stated_ && *stated_ != static_cast<double>(count_))
      throw DamagedFile(name() + " is damaged: it holds " + counted(count_, "point") + ", " +
                        (scans_ == 1 ? "its first line says " : "the counts of its scans say ") +
                        std::to_string(static_cast<long long>(*stated_)));
    if (points_.empty())
      throw std::invalid_argument(name() + " holds no finite point: expected lines of x, y and z");
    return std::move(points_);
  }

 private:
  std::string name() const { return "'" + plain(file_.string()) + "'"; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw DamagedFile(name() + " is damaged: line " + std::to_string(line_) + " " + what +
                      ", expected x, y and z of a point, or a head that names these columns");
  }

  void take_line(std::string_view line) {
    if (line.empty()) return;
    if (take_comment(line)) {
      if (std::vector<std::string> names = columns_of(line); count_ == 0 && places_of(names))
        head_ = std::move(names);
      return;
    }
    if (begin_next_scan(line) || (!has_begun_ && begin(line))) return;
    take_point(line);
  }

  /// A whole number alone on its line: of how many points.
  static std::optional<double> stated_count(const std::vector<std::string>& columns) {
    const std::optional<double> number = parsed_number(columns.front());
    const bool is_count = columns.size() == 1 && number && *number >= 0.0 && *number <= most_points &&
                          *number == std::floor(*number);
    return is_count ? number : std::nullopt;
  }

  /// Files of several scans, in one frame, state the count of each before its points.
  bool begin_next_scan(std::string_view line) {
    if (!stated_ || *stated_ != static_cast<double>(count_)) return false;
    const std::optional<double> more = stated_count(columns_of(line));
    if (more) *stated_ += *more, ++scans_;
    return more.has_value();
  }

  /// The first line that is no comment. @return whether it is no point
  bool begin(std::string_view line) {
    const std::vector<std::string> columns = columns_of(line);
    if (!stated_ && (stated_ = stated_count(columns))) return true;
    if (const auto places = places_of(columns)) {
      places_ = *places;
      head_.clear();
      return true;
    }
    has_begun_ = true;
    delimiter_ = delimiter_of(line);
    take_head(columns.size());
    last_place_ = *std::max_element(places_.begin(), places_.end());
    return false;
  }

  /// Of a commented head, which may be a sentence: more than three columns must be those that it names.
  void take_head(std::size_t columns) {
    if (head_.empty()) return;
    const Places places = *places_of(head_);
    if (head_.size() == columns)
      places_ = places;
    else if (columns > 3 && places != places_)
      refuse("has " + std::to_string(columns) + " columns, the comment above it " +
             std::to_string(head_.size()));
  }

  static std::string hint_of(std::string_view word) {
    const bool may_be_decimals =
        word.find_first_of(", \t") != word.npos && word.find_first_not_of("0123456789+-eE, \t") == word.npos;
    return may_be_decimals ? " (are these decimal commas? numbers have points)" : "";
  }

  void take_point(std::string_view line) {
    Eigen::Vector3f point;
    for (std::size_t column = 0; column <= last_place_; ++column) {
      if (line.empty()) refuse("has too few numbers");
      const std::string_view word = next_column(line, delimiter_);
      const auto axis = std::find(places_.begin(), places_.end(), column);
      if (axis == places_.end()) continue;
      const std::optional<double> number = parsed_number(word);
      const bool is_beyond =
          number && std::isfinite(*number) && std::abs(*number) > std::numeric_limits<float>::max();
      if (!number || is_beyond) refuse("has " + quote(word) + hint_of(word));
      point[axis - places_.begin()] = static_cast<float>(*number);
    }
    ++count_;
    if (point.allFinite()) points_.push_back(point);
  }

  const std::filesystem::path& file_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::string> head_;  ///< words of the last comment before the points
  Places places_{0, 1, 2};
  std::size_t last_place_ = 2, line_ = 0, count_ = 0;
  std::optional<double> stated_;
  int scans_ = 1;
  char delimiter_ = ' ';
  bool has_begun_ = false;
};

}  // namespace

bool is_xyz_file(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return kind == ".xyz" || kind == ".asc" || kind == ".pts";
}

std::vector<Eigen::Vector3f> read_xyz_file(const std::filesystem::path& file) {
  return XyzReader(file).read();
}

}  // namespace clearway
