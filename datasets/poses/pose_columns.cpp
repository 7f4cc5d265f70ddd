#include "datasets/poses/pose_columns.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "datasets/cameras/lower_case.hpp"
#include "datasets/sources/finite_number.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

std::vector<std::string> cells_of(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

namespace {

using Places = PoseColumns::Places;

/// The letter that a column's name ends in: w of qw, q_RS_w, rot.w and w; 0 where it is none of w, x, y, z.
char letter_of(const std::string& word) {
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  std::size_t end = word.size();
  while (end > 0 && !is_word(word[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_word(word[begin - 1])) --begin;
  if (end - begin == 0 || end - begin > 2) return 0;
  const char letter = word[end - 1];
  const bool has_known_kind =
      end - begin == 1 || std::string_view("qtpro").find(word[begin]) != std::string_view::npos;
  return has_known_kind && letter >= 'w' && letter <= 'z' ? letter : char{0};
}

/// Whether the head gives lengths in something else than metres: "[mm]", "(cm)".
std::optional<std::string> other_unit(const std::string& line) {
  for (const char* unit : {"mm", "cm", "dm", "km", "um", "in", "inch", "ft", "deg"})
    for (const auto& [open, close] : {std::pair("[", "]"), std::pair("(", ")")})
      if (line.find(open + std::string(unit) + close) != std::string::npos) return unit;
  return std::nullopt;
}

/// Whether a column's name, in small letters, is one of a quaternion's: qw, rot.w, orientation_x.
bool is_of_turn(const std::string& word) {
  return word.starts_with("q") || word.starts_with("#q") || word.find("rot") != std::string::npos ||
         word.find("ori") != std::string::npos || word.find("quat") != std::string::npos;
}

/// What a head says of the columns: "xyzwxyz" of "# time tx ty tz qw qx qy qz".
struct Head {
  std::string letters, turn;  ///< all; those that names like qw or rot.w give to the quaternion
  bool begins_with_turn = false;
};

/// Nothing when the line is no head: it names no w among four columns or more.
std::optional<Head> head_of(std::string line) {
  line = lower_case(line);
  for (char& c : line)
    if (c == '[' || c == '(') c = ' ';
  Head head;
  std::vector<std::string> names = cells_of(line);
  const auto has = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const bool has_alone = has("i") && has("j") && has("k");  // w, i, j, k are a quaternion's, too
  for (std::string& name : names) {
    if (has_alone && name == "w") name = "qw";
    const std::size_t axis = std::string_view("ijk").find(name.back());
    if (axis == std::string_view::npos || !(is_of_turn(name) || (has_alone && name.size() == 1))) continue;
    name.back() = "xyz"[axis];
    if (name.size() == 1) name.insert(0, "q");
  }
  for (const std::string& word : names) {
    const char letter = letter_of(word);
    if (letter == 0) continue;
    head.begins_with_turn |= head.letters.empty() && is_of_turn(word);
    head.letters += letter;
    if (is_of_turn(word)) head.turn += letter;
  }
  if (head.letters.size() < 4 || head.letters.find('w') == std::string::npos) return std::nullopt;
  return head;
}

/// Whether qw comes first; nothing where that is not said, or the quaternion stands before the place.
std::optional<bool> is_w_first_in(const Head& head) {
  const auto is_first = [](std::string_view order) -> std::optional<bool> {
    if (order == "wxyz") return true;
    if (order == "xyzw") return false;
    return std::nullopt;
  };
  if (!head.turn.empty() && head.turn.size() != 4) return std::nullopt;  // some have names that mean nothing
  if (head.turn.size() == 4)
    return head.begins_with_turn && head.letters.size() > 4 ? std::nullopt : is_first(head.turn);
  if (head.letters.size() == 4) return is_first(head.letters);
  return head.letters.starts_with("xyz") ? is_first(std::string_view(head.letters).substr(3, 4))
                                         : std::nullopt;
}

/// Of a head that names each once, in any order; the time may be what comes first and is none of them.
std::optional<Places> places_by_name(std::string line) {
  line = lower_case(line);
  std::replace(line.begin(), line.end(), '#', ' ');
  const bool has_commas = line.find(',') != std::string::npos;
  std::vector<std::string> names = cells_of(line);
  if (has_commas) {
    names.clear();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      const std::vector<std::string> words = cells_of(cell);
      names.push_back(words.empty() ? "" : words.front());
    }
  }
  Places places{};
  std::array<int, 8> found{};
  const auto note = [&](std::size_t role, std::size_t column) {
    places[role] = column;
    ++found[role];
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char letter = letter_of(names[i]);
    if (letter != 0) {
      const std::size_t role = std::string_view(is_of_turn(names[i]) ? "    xyzw" : " xyz").find(letter);
      if (role == std::string_view::npos) return std::nullopt;
      note(role, i);
    } else if (i == 0 || (names[i].starts_with("time") && !names[places[0]].starts_with("time"))) {
      found[0] = 0;  // a counter stands before the time
      note(0, i);
    }
  }
  const bool is_whole = std::all_of(found.begin(), found.end(), [](int count) { return count == 1; });
  return is_whole ? std::optional(places) : std::nullopt;
}

std::size_t count_of_names(std::string line) {
  std::replace(line.begin(), line.end(), '#', ' ');
  return cells_of(line).size();
}

/// Time, x, y, z, qx, qy, qz and qw of a line; fewer words where it is too short.
std::vector<std::string> in_order(const std::vector<std::string>& words, const Places& places) {
  std::vector<std::string> ordered;
  for (const std::size_t column : places) {
    if (column < words.size()) ordered.push_back(words[column]);
  }
  return ordered;
}

/// How many columns, of a counter and of seconds, stand before nanoseconds in a head such as Newer College's
/// "#sec,nsec,x,y,…" or "# counter, sec, nsec, x, …"; 0: it has no such time.
std::size_t columns_before_nanoseconds(std::string line) {
  line = lower_case(line);
  std::replace(line.begin(), line.end(), '#', ' ');
  const std::vector<std::string> words = cells_of(line);
  const auto is_one_of = [&](std::size_t at, std::initializer_list<const char*> names) {
    return at < words.size() && std::find(names.begin(), names.end(), words[at]) != names.end();
  };
  for (std::size_t at : {0U, 1U})
    if (is_one_of(at, {"sec", "secs"}) && is_one_of(at + 1, {"nsec", "nsecs", "nanosec"})) return at + 1;
  return 0;
}

/// Takes what stands before the seconds, and the nanoseconds, away. @return these, as seconds; nothing when
/// they are none
std::optional<double> take_nanoseconds(std::vector<std::string>& words, std::size_t before) {
  if (before == 0) return 0.0;
  if (words.size() <= before) return std::nullopt;
  const auto nanoseconds = finite_number(words[before]);
  if (!nanoseconds || *nanoseconds < 0.0 || *nanoseconds >= 1e9) return std::nullopt;
  words.erase(words.begin() + static_cast<std::ptrdiff_t>(before));
  words.erase(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(before) - 1);
  return 1e-9 * *nanoseconds;
}

/// @throws std::invalid_argument where it gives lengths or angles in another unit
void require_metres(const std::string& line) {
  if (const auto unit = other_unit(line))
    throw std::invalid_argument("expected metres and a quaternion, got columns in " + *unit);
}

}  // namespace

std::optional<PoseColumns> columns_of_head(const std::string& line) {
  const auto head = head_of(line);
  if (!head) return std::nullopt;
  PoseColumns columns;
  columns.has_head = true;
  const auto said = is_w_first_in(*head);
  columns.before_nanoseconds = columns_before_nanoseconds(line);
  if (columns.before_nanoseconds == 0) columns.by_name = places_by_name(line);
  const auto commas = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
  if (said && columns.by_name && columns.by_name->front() == 0) {  // time, then a pose as it is usual
    columns.by_name.reset();
    columns.count_with_blanks = commas == 0 ? count_of_names(line) : 0;
  }
  if (!said && !columns.by_name)
    throw std::invalid_argument(
        "expected columns x y z and then a quaternion as qx qy qz qw or qw qx qy qz, or columns "
        "named time, x, y, z, qx, qy, qz and qw, got " +
        quote(head->letters));
  require_metres(line);
  columns.is_w_first = !columns.by_name && said.value_or(false);
  const bool is_pose_first = head->letters.starts_with(columns.is_w_first ? "xyzwxyz" : "xyzxyzw");
  const std::size_t with_one_time = commas + 1 - std::min(commas, columns.before_nanoseconds);
  if (!columns.by_name && is_pose_first && with_one_time > 8) columns.count = with_one_time;
  return columns;
}

PoseWords pose_words(std::vector<std::string> words, const PoseColumns& columns) {
  const auto nanoseconds = take_nanoseconds(words, columns.before_nanoseconds);
  if (words.size() == columns.count || (words.size() > 8 && words.size() == columns.count_with_blanks))
    words.resize(8);
  return {columns.by_name ? in_order(words, *columns.by_name) : std::move(words), nanoseconds};
}

std::string PoseColumns::expected() const {
  return std::string(before_nanoseconds > 0 ? "expected 'sec nsec x y z " : "expected 'time x y z ") +
         (is_w_first ? "qw qx qy qz" : "qx qy qz qw") + "' with a unit quaternion";
}

}  // namespace clearway
