#include "datasets/sources/pose_stream.hpp"

#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DInterpolator.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "datasets/sources/clock_seconds.hpp"
#include "datasets/sources/finite_number.hpp"
#include "datasets/sources/observation_decoder.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

struct PoseStream::State {
  mrpt::poses::CPose3DInterpolator poses;
  double max_gap = 0.0;
  std::vector<PoseStream::Jump> jumps;
};

PoseStream::PoseStream(double max_gap) : state_(std::make_unique<State>()) {
  if (!(max_gap > 0.0) || !std::isfinite(max_gap))
    throw std::invalid_argument("a pose stream's longest gap must be above 0 s");
  state_->max_gap = max_gap;
  state_->poses.setInterpolationMethod(mrpt::poses::imLinearSlerp);
}
PoseStream::~PoseStream() = default;
PoseStream::PoseStream(PoseStream&&) noexcept = default;
PoseStream& PoseStream::operator=(PoseStream&&) noexcept = default;

void PoseStream::add(double time, const Eigen::Isometry3d& pose) {
  if (!std::isfinite(time) || !pose.matrix().allFinite())
    throw std::invalid_argument("a pose stream takes finite times and poses only");
  const Eigen::Matrix3d rotation = pose.linear();
  mrpt::poses::CPose3D reading;
  reading.setRotationMatrix(mrpt::math::CMatrixDouble33(rotation));
  for (int axis = 0; axis < 3; ++axis) reading.m_coords[axis] = pose.translation()[axis];
  state_->poses.insert(mrpt::Clock::fromDouble(time), reading.asTPose());
}

std::optional<Eigen::Isometry3d> PoseStream::at(double time) const {
  constexpr double never = std::numeric_limits<double>::infinity();
  const Around readings = around(time);
  const double gap = readings.after.value_or(never) - readings.before.value_or(-never);
  if (gap > state_->max_gap || is_in_jump(time)) return std::nullopt;
  mrpt::poses::CPose3D pose;
  bool valid = false;
  state_->poses.interpolate(mrpt::Clock::fromDouble(time), pose, valid);
  if (!valid) return std::nullopt;
  return isometry(pose);
}

std::optional<Eigen::Isometry3d> PoseStream::nearest(double time) const {
  if (state_->poses.empty() || !std::isfinite(time)) return std::nullopt;
  auto best = state_->poses.lower_bound(mrpt::Clock::fromDouble(time));
  const auto away = [time](const auto& reading) {
    return std::abs(mrpt::Clock::toDouble(reading->first) - time);
  };
  if (best == state_->poses.end()) best = std::prev(best);
  if (best != state_->poses.begin() && away(std::prev(best)) < away(best)) best = std::prev(best);
  if (away(best) > state_->max_gap || is_in_jump(time)) return std::nullopt;
  return isometry(mrpt::poses::CPose3D(best->second));
}

namespace {

/// The middle of the rates that are not 0, where there are five or more.
std::optional<double> usual(std::vector<double> rates) {
  constexpr std::size_t least = 5;
  std::erase(rates, 0.0);
  if (rates.size() < least) return std::nullopt;
  const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  return *middle;
}

}  // namespace

void PoseStream::leave_out_jumps() {
  std::vector<Jump> steps;
  std::vector<double> speeds, turns;
  std::optional<std::pair<double, Eigen::Isometry3d>> before;
  for (const auto& [stamp, reading] : state_->poses) {
    const double time = mrpt::Clock::toDouble(stamp);
    const Eigen::Isometry3d pose = isometry(mrpt::poses::CPose3D(reading));
    if (before && time - before->first <= state_->max_gap) {
      const Eigen::Isometry3d step = before->second.inverse() * pose;
      steps.push_back({before->first, time, step.translation().norm(),
                       std::abs(Eigen::AngleAxisd(step.linear()).angle())});
      speeds.push_back(steps.back().shift / (time - before->first));
      turns.push_back(steps.back().turn / (time - before->first));
    }
    before.emplace(time, pose);
  }
  constexpr double least = 0.3;  // m, rad
  constexpr double times = 5.0, fastest = 60.0, fastest_turn = 30.0;
  const auto of_usual = [&](const std::vector<double>& rates, double otherwise) {
    const auto found = usual(rates);
    return found ? times * *found : otherwise;
  };
  const double most = of_usual(speeds, fastest), most_turn = of_usual(turns, fastest_turn);
  state_->jumps.clear();
  for (std::size_t i = 0; i < steps.size(); ++i)
    if ((steps[i].shift > least && speeds[i] > most) || (steps[i].turn > least && turns[i] > most_turn))
      state_->jumps.push_back(steps[i]);
}

const std::vector<PoseStream::Jump>& PoseStream::jumps() const { return state_->jumps; }

bool PoseStream::is_in_jump(double time) const {
  const auto after = std::upper_bound(state_->jumps.begin(), state_->jumps.end(), time,
                                      [](double at, const Jump& jump) { return at < jump.after; });
  return after != state_->jumps.end() && after->before < time;
}

PoseStream::Around PoseStream::around(double time) const {
  if (state_->poses.empty() || !std::isfinite(time)) return {};
  const auto stamp = mrpt::Clock::fromDouble(time);
  const auto after = state_->poses.lower_bound(stamp);
  Around result;
  if (after != state_->poses.end()) result.after = mrpt::Clock::toDouble(after->first);
  if (after != state_->poses.end() && after->first == stamp)
    result.before = result.after;
  else if (after != state_->poses.begin())
    result.before = mrpt::Clock::toDouble(std::prev(after)->first);
  return result;
}

std::optional<double> PoseStream::first_time() const {
  if (state_->poses.empty()) return std::nullopt;
  return mrpt::Clock::toDouble(state_->poses.begin()->first);
}

std::optional<double> PoseStream::last_time() const {
  if (state_->poses.empty()) return std::nullopt;
  return mrpt::Clock::toDouble(state_->poses.rbegin()->first);
}

std::size_t PoseStream::size() const { return state_->poses.size(); }

std::optional<double> PoseStream::usual_speed() const {
  std::vector<double> speeds;
  if (state_->poses.empty()) return std::nullopt;
  auto before = state_->poses.begin();  // the first of those that are the same: some logs repeat a pose
  for (auto next = std::next(before); next != state_->poses.end(); ++next) {
    const double way = (next->second - before->second).translation().norm();
    if (!(way > 0.0)) continue;
    const double time = mrpt::Clock::toDouble(next->first) - mrpt::Clock::toDouble(before->first);
    if (time > 0.0) speeds.push_back(way / time);
    before = next;
  }
  return usual(std::move(speeds));
}

namespace {

/// Words of a line, with commas for blanks.
std::vector<std::string> words_of(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

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

std::string small_letters(std::string line) {
  for (char& c : line) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return line;
}

/// What a head says of the columns: "xyzwxyz" of "# time tx ty tz qw qx qy qz".
struct Head {
  std::string letters, turn;  ///< all; those that names like qw or rot.w give to the quaternion
  bool begins_with_turn = false;
};

/// Nothing when the line is no head: it names no w among four columns or more.
std::optional<Head> head_of(std::string line) {
  line = small_letters(line);
  for (char& c : line)
    if (c == '[' || c == '(') c = ' ';
  Head head;
  std::vector<std::string> names = words_of(line);
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

/// Where time, x, y, z, qx, qy, qz and qw stand in a line.
using Columns = std::array<std::size_t, 8>;

/// Of a head that names each once, in any order; the time may be what comes first and is none of them.
std::optional<Columns> columns_by_name(std::string line) {
  line = small_letters(line);
  std::replace(line.begin(), line.end(), '#', ' ');
  const bool has_commas = line.find(',') != std::string::npos;
  std::vector<std::string> names = words_of(line);
  if (has_commas) {
    names.clear();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      const std::vector<std::string> words = words_of(cell);
      names.push_back(words.empty() ? "" : words.front());
    }
  }
  Columns columns{};
  std::array<int, 8> found{};
  const auto note = [&](std::size_t role, std::size_t column) {
    columns[role] = column;
    ++found[role];
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char letter = letter_of(names[i]);
    if (letter != 0) {
      const std::size_t role = std::string_view(is_of_turn(names[i]) ? "    xyzw" : " xyz").find(letter);
      if (role == std::string_view::npos) return std::nullopt;
      note(role, i);
    } else if (i == 0 || (names[i].starts_with("time") && !names[columns[0]].starts_with("time"))) {
      found[0] = 0;  // a counter stands before the time
      note(0, i);
    }
  }
  const bool is_whole = std::all_of(found.begin(), found.end(), [](int count) { return count == 1; });
  return is_whole ? std::optional(columns) : std::nullopt;
}

std::size_t count_of_names(std::string line) {
  std::replace(line.begin(), line.end(), '#', ' ');
  return words_of(line).size();
}

/// Time, x, y, z, qx, qy, qz and qw of a line; fewer words where it is too short.
std::vector<std::string> in_order(const std::vector<std::string>& words, const Columns& columns) {
  std::vector<std::string> ordered;
  for (const std::size_t column : columns) {
    if (column < words.size()) ordered.push_back(words[column]);
  }
  return ordered;
}

/// How many columns, of a counter and of seconds, stand before nanoseconds in a head such as Newer College's
/// "#sec,nsec,x,y,…" or "# counter, sec, nsec, x, …"; 0: it has no such time.
std::size_t columns_before_nanoseconds(std::string line) {
  for (char& c : line) c = c == '#' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::vector<std::string> words = words_of(line);
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

struct TimedPose {
  double time;
  Eigen::Isometry3d pose;
};

/// Nothing when it is not eight numbers with a unit quaternion.
std::optional<TimedPose> timed_pose(const std::vector<std::string>& words, bool is_w_first) {
  if (words.size() != 8) return std::nullopt;
  std::array<double, 8> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::optional<double> number =
        finite_number(words[i].starts_with('+') ? words[i].substr(1) : words[i]);
    if (!number) return std::nullopt;
    v[i] = *number;
  }
  const Eigen::Quaterniond turn =
      is_w_first ? Eigen::Quaterniond(v[4], v[5], v[6], v[7]) : Eigen::Quaterniond(v[7], v[4], v[5], v[6]);
  if (!(std::abs(turn.norm() - 1.0) < 1e-2)) return std::nullopt;
  Eigen::Isometry3d pose(turn.normalized());
  pose.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
  return TimedPose{v[0], pose};
}

/// A time and seven words, some of which say that they are not known.
bool is_unknown_pose(const std::vector<std::string>& words) {
  return words.size() == 8 && finite_number(words.front()) &&
         std::any_of(words.begin() + 1, words.end(), [](std::string word) {
           for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
           return word.find("nan") != std::string::npos || word.find("inf") != std::string::npos;
         });
}

/// Of two poses of one time, such as of a file that is two recordings, none is taken. Times that were rounded
/// may have two that are near each other.
void require_near(const Eigen::Isometry3d& one, const Eigen::Isometry3d& two, double time,
                  const std::string& name) {
  constexpr double near_within = 0.1;  // m, rad
  const Eigen::Isometry3d other = one.inverse() * two;
  const double turn = Eigen::AngleAxisd(other.linear()).angle();
  if (other.translation().norm() <= near_within && turn <= near_within) return;
  throw std::invalid_argument(name + ": expected one pose a time, got two that are " +
                              short_text(other.translation().norm(), 3) + " m and " + short_text(turn, 3) +
                              " rad apart at " + short_text(time, 15) + " s");
}

}  // namespace

PoseStream parse_tum_poses(const std::string& text, const std::string& name, double max_gap,
                           std::size_t* left_out) {
  std::istringstream lines(text);
  std::vector<TimedPose> poses;
  int number = 0;
  bool is_w_first = false;
  std::size_t columns = 0;             // of a head that names more than a time and a pose
  std::size_t blank_columns = 0;       // names in one without commas
  std::size_t before_nanoseconds = 0;  // of a head that names them
  std::optional<Columns> by_name;      // of a head that names them in another order
  bool has_head = false;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument(name + ", line " + std::to_string(number) + ": " + why);
    };
    if (const auto head = head_of(line); head && poses.empty()) {
      has_head = true;
      const auto said = is_w_first_in(*head);
      before_nanoseconds = columns_before_nanoseconds(line);
      by_name = before_nanoseconds > 0 ? std::nullopt : columns_by_name(line);
      if (said && by_name && by_name->front() == 0) {  // time, then a pose as it is usual
        by_name.reset();
        blank_columns = line.find(',') == std::string::npos ? count_of_names(line) : 0;
      }
      if (!said && !by_name)
        refuse(
            "expected columns x y z and then a quaternion as qx qy qz qw or qw qx qy qz, or columns "
            "named time, x, y, z, qx, qy, qz and qw, got " +
            quote(head->letters));
      if (const auto unit = other_unit(line))
        refuse("expected metres and a quaternion, got columns in " + *unit);
      is_w_first = !by_name && said.value_or(false);
      const bool is_pose_first = head->letters.starts_with(is_w_first ? "xyzwxyz" : "xyzxyzw");
      const auto commas = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
      const std::size_t with_one_time = commas + 1 - std::min(commas, before_nanoseconds);
      columns = !by_name && is_pose_first && with_one_time > 8 ? with_one_time : 0;
      continue;
    }
    line.resize(std::min(line.find('#'), line.size()));
    std::vector<std::string> words = words_of(line);
    if (words.empty()) continue;
    if (!has_head && words.size() == 8 && line.find(',') != std::string::npos)
      refuse(
          "programs that write commas differ in where qw stands, expected a first line that names the "
          "columns, such as 'time,x,y,z,qx,qy,qz,qw' or 'time,x,y,z,qw,qx,qy,qz'");
    const auto nanoseconds = take_nanoseconds(words, before_nanoseconds);
    if (words.size() == columns || (words.size() > 8 && words.size() == blank_columns)) words.resize(8);
    if (by_name) words = in_order(words, *by_name);
    auto pose = nanoseconds ? timed_pose(words, is_w_first) : std::nullopt;
    if (pose) pose->time += *nanoseconds;
    const std::streamoff next = lines.tellg();
    const bool is_last =
        next < 0 || text.find_first_not_of(" \t\r\n", static_cast<std::size_t>(next)) == std::string::npos;
    if (!pose && left_out != nullptr &&
        (is_unknown_pose(words) || (is_last && !poses.empty() && words.size() < 8))) {
      ++*left_out;
      continue;
    }
    if (!pose)
      refuse(std::string(before_nanoseconds > 0 ? "expected 'sec nsec x y z " : "expected 'time x y z ") +
             (is_w_first ? "qw qx qy qz" : "qx qy qz qw") + "' with a unit quaternion" +
             (words.size() == 8 || before_nanoseconds > 0
                  ? ""
                  : ", got " + std::to_string(words.size()) + " columns"));
    poses.push_back(*pose);
  }
  if (poses.empty()) throw std::invalid_argument(name + ": expected at least one pose");
  std::vector<double> times;
  for (const TimedPose& pose : poses) times.push_back(pose.time);
  make_seconds(times);
  PoseStream stream(max_gap);
  std::map<double, const Eigen::Isometry3d*> places;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto [known, is_new] = places.emplace(times[i], &poses[i].pose);
    if (!is_new) require_near(*std::exchange(known->second, &poses[i].pose), poses[i].pose, times[i], name);
    stream.add(times[i], poses[i].pose);
  }
  stream.leave_out_jumps();
  return stream;
}

PoseStream load_tum_poses(const std::filesystem::path& file, double max_gap, std::size_t* left_out) {
  const std::string name = "poses " + quote_path(file.string());
  const std::string text = read_input(file, "poses", 256U << 20U);
  return parse_tum_poses(text, name, max_gap, left_out);
}

std::optional<std::string> too_fast_poses(const std::filesystem::path& file, const PoseStream& poses) {
  constexpr double fastest = 60.0;  // m/s
  const auto speed = poses.usual_speed();
  if (!speed || *speed <= fastest) return std::nullopt;
  return "poses " + quote_path(file.string()) + " usually move at " + std::to_string(std::lround(*speed)) +
         " m/s from line to line, which are hardly metres and seconds: expected metres, not millimetres";
}

std::optional<std::string> jumping_poses(const std::filesystem::path& file, const PoseStream& poses) {
  const std::vector<PoseStream::Jump>& jumps = poses.jumps();
  if (jumps.empty()) return std::nullopt;
  const auto farthest = std::max_element(jumps.begin(), jumps.end(), [](const auto& a, const auto& b) {
    return a.shift + a.turn < b.shift + b.turn;
  });
  const std::string count = jumps.size() == 1 ? "once" : std::to_string(jumps.size()) + " times, farthest";
  return "poses " + quote_path(file.string()) + " jump " + count + " by " + short_text(farthest->shift, 3) +
         " m and " + short_text(farthest->turn, 3) + " rad between " + short_text(farthest->before, 15) +
         " and " + short_text(farthest->after, 15) + " s: what was seen within a jump is left out";
}

std::string left_out_poses(const std::filesystem::path& file, std::size_t left_out) {
  return "poses " + quote_path(file.string()) + ": " + std::to_string(left_out) +
         (left_out == 1 ? " line says" : " lines say") + " no pose (nan, or cut off) and " +
         (left_out == 1 ? "was" : "were") + " left out";
}

}  // namespace clearway
