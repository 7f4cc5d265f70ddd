#include "datasets/sources/joint_stream.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "datasets/sources/finite_number.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const std::size_t begin = cell.find_first_not_of(" \t\r"), end = cell.find_last_not_of(" \t\r");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end + 1 - begin));
  }
  return cells;
}

}  // namespace

void JointStream::add(double time, const std::vector<std::string>& names,
                      const std::vector<double>& positions) {
  const bool is_finite =
      std::isfinite(time) && std::all_of(positions.begin(), positions.end(),
                                         [](double position) { return std::isfinite(position); });
  if (!is_finite || names.size() != positions.size())
    throw std::invalid_argument("a stream of joints takes one finite position for each name");
  for (std::size_t i = 0; i < names.size(); ++i) readings_[names[i]][time] = positions[i];
}

/// How far a joint moved from one reading to another.
double JointStream::way(const std::string& name, double from, double to) const {
  return wrapping_.contains(name) ? std::remainder(to - from, 2.0 * std::numbers::pi) : to - from;
}

std::optional<double> JointStream::position_at(const std::string& name, double time) const {
  const Readings& readings = readings_.at(name);
  const auto after = readings.lower_bound(time);
  if (after == readings.end()) return std::nullopt;
  if (after->first == time) return after->second;
  if (after == readings.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double gap = after->first - before->first;
  if (gap > max_gap_) return std::nullopt;
  return before->second + (time - before->first) / gap * way(name, before->second, after->second);
}

std::optional<std::vector<double>> JointStream::at(const std::vector<std::string>& names, double time) const {
  std::vector<double> positions;
  for (const std::string& name : names) {
    const auto joint = readings_.find(name);
    const auto position = joint == readings_.end() ? std::nullopt : position_at(name, time);
    if (!position) return std::nullopt;
    positions.push_back(*position);
  }
  return positions;
}

std::string JointStream::why_unknown(const std::vector<std::string>& names, double time) const {
  for (const std::string& name : names) {
    const auto joint = readings_.find(name);
    if (joint == readings_.end()) return "joint " + quote(name) + " has no reading";
    if (position_at(name, time)) continue;
    const Readings& readings = joint->second;
    const auto after = readings.lower_bound(time);
    if (after == readings.end() || after == readings.begin())
      return "readings of joint " + quote(name) + " go from " + short_text(readings.begin()->first, 15) +
             " to " + short_text(readings.rbegin()->first, 15) + " s, this is at " + short_text(time, 15) +
             " s";
    return "readings of joint " + quote(name) + " lie " +
           short_text(after->first - std::prev(after)->first, 6) + " s apart, expected at most " +
           short_text(max_gap_, 6) + " s";
  }
  return "";
}

std::vector<double> JointStream::deviations(const std::vector<std::string>& names, double time,
                                            double span) const {
  std::vector<double> result;
  for (const std::string& name : names) {
    const Readings& readings = readings_.at(name);
    const double here = *position_at(name, time);
    double most = 0.0;
    const auto take = [&](double position) { most = std::max(most, std::abs(way(name, here, position))); };
    // Between readings it goes in straight lines: it is farthest at a reading or at an end of the span.
    for (auto it = readings.lower_bound(time - span); it != readings.end() && it->first <= time + span; ++it)
      take(it->second);
    for (const double end : {time - span, time + span})
      if (const auto position = position_at(name, end)) take(*position);
    result.push_back(most);
  }
  return result;
}

/// From the straight lines to the readings about half the gap away and farther, which noise bends little.
std::optional<double> JointStream::shown_acceleration(const std::string& name, Reading before,
                                                      Reading after) const {
  const Readings& readings = readings_.at(name);
  const double half = 0.5 * (after->first - before->first);
  const auto speed = [&](Reading from, Reading to) {
    return way(name, from->second, to->second) / (to->first - from->first);
  };
  std::optional<double> most;
  const auto take = [&](Reading first, Reading middle, Reading last) {
    if (middle->first - first->first > max_gap_ || last->first - middle->first > max_gap_) return;
    const double change = std::abs(speed(middle, last) - speed(first, middle));
    most = std::max(most.value_or(0.0), 2.0 * change / (last->first - first->first));
  };
  const auto earlier = readings.upper_bound(before->first - half);
  if (earlier != readings.begin()) take(std::prev(earlier), before, after);
  const auto later = readings.lower_bound(after->first + half);
  if (later != readings.end()) take(before, after, later);
  return most;
}

/// Of the readings within a second, those around that time among them.
double JointStream::usual_spacing(const std::string& name, double time) const {
  const Readings& readings = readings_.at(name);
  const auto first = readings.lower_bound(time - 1.0), last = std::prev(readings.upper_bound(time + 1.0));
  const auto spacings = static_cast<double>(std::distance(first, last));
  return spacings > 0.0 ? (last->first - first->first) / spacings : 0.0;
}

double JointStream::acceleration(const std::string& name, Reading before, Reading after, double usual) const {
  constexpr double most_spacings = 2.5;  // one reading may be missing
  constexpr double of_any_joint = 10.0;
  const auto stated = accelerations_.find(name);
  const double possible = stated == accelerations_.end() ? of_any_joint : stated->second;
  const auto shown = shown_acceleration(name, before, after);
  if (!shown) return possible;
  const bool is_usual = after->first - before->first <= most_spacings * usual;
  return is_usual ? 2.0 * *shown : std::max(2.0 * *shown, possible);
}

std::vector<double> JointStream::uncertainties(const std::vector<std::string>& names, double time,
                                               double span) const {
  std::vector<double> result;
  for (const std::string& name : names) {
    const Readings& readings = readings_.at(name);
    const double usual = usual_spacing(name, time);
    double most = 0.0;
    auto after = readings.upper_bound(time - span);
    if (after == readings.begin()) ++after;
    for (; after != readings.end() && std::prev(after)->first < time + span; ++after) {
      const auto before = std::prev(after);
      const double gap = after->first - before->first;
      if (gap > max_gap_) continue;
      const double since = std::clamp(0.5 * gap, std::max(0.0, time - span - before->first),
                                      std::min(gap, time + span - before->first));
      const double bend = 0.5 * since * (gap - since);
      if (bend > 0.0) most = std::max(most, bend * acceleration(name, before, after, usual));
    }
    result.push_back(most);
  }
  return result;
}

std::vector<double> JointStream::times(const std::vector<std::string>& names) const {
  std::vector<double> times;
  const auto first = names.empty() ? readings_.end() : readings_.find(names.front());
  if (first == readings_.end()) return times;
  for (const auto& [time, position] : first->second) {
    const bool are_all_read =
        std::all_of(names.begin(), names.end(), [&, at = time](const std::string& name) {
          const auto joint = readings_.find(name);
          return joint != readings_.end() && joint->second.contains(at);
        });
    if (are_all_read) times.push_back(time);
  }
  return times;
}

std::vector<std::string> JointStream::names() const {
  std::vector<std::string> names;
  for (const auto& [name, readings] : readings_) names.push_back(name);
  return names;
}

void JointStream::rename(const std::map<std::string, std::string>& own_names) {
  std::map<std::string, Readings> renamed = readings_;
  for (const auto& [name, own] : own_names) renamed.erase(own);
  for (const auto& [name, own] : own_names) renamed[name] = readings_.at(own);
  readings_ = std::move(renamed);
}

std::optional<double> JointStream::last_time() const {
  std::optional<double> last;
  for (const auto& [name, readings] : readings_)
    last = std::max(last.value_or(readings.rbegin()->first), readings.rbegin()->first);
  return last;
}

JointStream parse_joint_states(const std::string& text, const std::string& name, double max_gap) {
  JointStream stream(max_gap);
  std::istringstream in(text);
  std::vector<std::string> names;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.starts_with('#')) continue;
    const auto fail = [&](const std::string& expected) {
      throw std::invalid_argument(quote_path(name) + ", line " + std::to_string(number) + ": expected " +
                                  expected);
    };
    std::vector<std::string> cells = cells_of(line);
    if (names.empty()) {
      if (cells.size() < 2 || cells[0] != "time") fail("'time' and the names of joints, apart by commas");
      names.assign(cells.begin() + 1, cells.end());
      std::vector<std::string> sorted = names;
      std::sort(sorted.begin(), sorted.end());
      if (sorted.front().empty() || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
        fail("a name of its own for each joint");
      continue;
    }
    std::vector<double> numbers;
    for (const std::string& cell : cells) {
      const auto value = finite_number(cell);
      if (!value) fail("finite numbers apart by commas, got " + quote(cell));
      numbers.push_back(*value);
    }
    if (numbers.size() != names.size() + 1)
      fail(counted(names.size() + 1, "number") + ", got " + std::to_string(numbers.size()));
    stream.add(numbers[0], names, {numbers.begin() + 1, numbers.end()});
  }
  if (stream.empty())
    throw std::invalid_argument(
        quote_path(name) + " holds no joint positions: expected a line 'time, NAME, …' and lines of numbers");
  return stream;
}

JointStream load_joint_states(const std::filesystem::path& file, double max_gap) {
  return parse_joint_states(read_input(file, "joint positions", 256U << 20U), file.string(), max_gap);
}

}  // namespace clearway
