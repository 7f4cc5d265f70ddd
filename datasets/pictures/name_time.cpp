#include "datasets/pictures/name_time.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <regex>

#include "datasets/sources/finite_number.hpp"

namespace clearway {
namespace {

constexpr char name_digits[] = "0123456789", name_digits_and_point[] = "0123456789.";

/// Microseconds, behind the number of the picture.
std::optional<double> redwood_time(const std::string& stem) {
  const std::size_t dash = stem.find('-');
  if (dash == std::string::npos || dash == 0 || stem.size() != dash + 13 ||
      stem.find_first_not_of(name_digits) != dash ||
      stem.find_first_not_of(name_digits, dash + 1) != std::string::npos)
    return std::nullopt;
  return 1e-6 * finite_number(stem.substr(dash + 1)).value_or(0.0);
}

/// Ten digits of seconds and nine of nanoseconds, at the end or the beginning.
std::optional<double> stamp_time(const std::string& stem) {
  static const std::regex pattern("(?:.*[^0-9])?(\\d{10})[_-](\\d{9})|(\\d{10})[_-](\\d{9})[^0-9].*");
  std::smatch found;
  if (stem.size() > 100 || !std::regex_match(stem, found, pattern)) return std::nullopt;
  const std::size_t at = found[1].matched ? 1 : 3;
  return *finite_number(found[at].str()) + 1e-9 * *finite_number(found[at + 1].str());
}

/// A date and a time of day at the end of the name: eight digits and six, with marks between their numbers or
/// without, then a fraction behind a point or of exactly three or six digits.
std::optional<double> date_time(const std::string& stem) {
  static const std::regex pattern(
      "(?:^|.*[^0-9])(\\d{4})[-_.]?(\\d{2})[-_.]?(\\d{2})[-_.T ]?(\\d{2})[-_.:h]?(\\d{2})[-_.:m]?(\\d{2})"
      "(?:\\.(\\d+)|[-_]?(\\d{3}|\\d{6}))?");
  std::smatch found;
  if (stem.size() > 100 || !std::regex_match(stem, found, pattern)) return std::nullopt;
  const auto number = [&](std::size_t i) { return std::stoi(found[i].str()); };
  if (number(1) < 1970 || number(1) > 2199) return std::nullopt;
  const auto whole = seconds_of_date(number(1), number(2), number(3), number(4), number(5), number(6));
  const std::string fraction = found[7].str() + found[8].str();
  if (!whole || fraction.empty()) return whole;
  return *whole + *finite_number("0." + fraction);
}

/// ARKitScenes: eight digits of the recording, and seconds with milliseconds.
std::optional<double> arkit_time(const std::string& stem) {
  static const std::regex pattern("\\d{8}_(\\d{1,8}\\.\\d{3})");
  std::smatch found;
  if (stem.size() > 30 || !std::regex_match(stem, found, pattern)) return std::nullopt;
  return finite_number(found[1].str());
}

/// Whether bare digits are a clock's milliseconds, microseconds or nanoseconds.
bool has_clock_digits(const std::string& text) {
  return text.find_first_not_of(name_digits) == std::string::npos &&
         (text.size() == 13 || text.size() == 16 || text.size() == 19);
}

}  // namespace

std::optional<double> seconds_of_date(int year, int month, int day, int hour, int minute, int second) {
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok() || hour < 0 || hour > 23 || minute < 0 || minute > 59 || second < 0 || second > 60)
    return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return static_cast<double>(days) * 86400.0 + hour * 3600.0 + minute * 60.0 + second;
}

std::optional<double> time_in_name(const std::string& stem) {
  const bool is_bare = !stem.empty() && stem.find_first_not_of(name_digits) == std::string::npos;
  if (const auto number = finite_number(stem)) {
    const auto date = is_bare && !has_clock_digits(stem) ? date_time(stem) : std::nullopt;
    return date ? date : number;
  }
  if (const auto time = redwood_time(stem)) return time;
  if (const auto time = stamp_time(stem)) return time;
  std::string end = stem.substr(stem.find_last_not_of(name_digits_and_point) + 1);
  end.erase(0, end.find_first_not_of('.'));
  std::string beginning = stem.substr(0, stem.find_first_not_of(name_digits_and_point));
  beginning.erase(beginning.find_last_not_of('.') + 1);
  for (const std::string& text : {end, beginning}) {
    const std::size_t point = text.find('.');
    const bool is_clock = point == std::string::npos ? has_clock_digits(text) : point == 10;
    if (is_clock)
      if (const auto clock = finite_number(text)) return clock;
  }
  const auto date = date_time(stem);
  return date ? date : arkit_time(stem);
}

std::map<double, std::filesystem::path> files_by_time(const std::vector<std::filesystem::path>& files) {
  std::map<double, std::filesystem::path> times;
  for (const std::filesystem::path& file : files)
    if (const auto time = time_in_name(file.stem().string())) times[*time] = file;
  return times;
}

const std::pair<const double, std::filesystem::path>* nearest_file(
    const std::map<double, std::filesystem::path>& files, double time, double most_apart) {
  auto next = files.lower_bound(time);
  if (next != files.begin() && (next == files.end() || time - std::prev(next)->first < next->first - time))
    --next;
  return next == files.end() || std::abs(next->first - time) > most_apart ? nullptr : &*next;
}

}  // namespace clearway
