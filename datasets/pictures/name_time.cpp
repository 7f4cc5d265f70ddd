#include "datasets/pictures/name_time.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "datasets/sources/finite_number.hpp"

namespace clearway {
namespace {

constexpr char digits[] = "0123456789", digits_and_point[] = "0123456789.";

/// Microseconds, behind the number of the picture.
std::optional<double> redwood_time(const std::string& stem) {
  const std::size_t dash = stem.find('-');
  if (dash == std::string::npos || dash == 0 || stem.size() != dash + 13 ||
      stem.find_first_not_of(digits) != dash || stem.find_first_not_of(digits, dash + 1) != std::string::npos)
    return std::nullopt;
  return 1e-6 * finite_number(stem.substr(dash + 1)).value_or(0.0);
}

/// Ten digits of seconds and nine of nanoseconds.
std::optional<double> stamp_time(const std::string& stem) {
  if (stem.size() != 20 || (stem[10] != '_' && stem[10] != '-')) return std::nullopt;
  if (stem.find_first_not_of(digits) != 10 || stem.find_first_not_of(digits, 11) != std::string::npos)
    return std::nullopt;
  return *finite_number(stem.substr(0, 10)) + 1e-9 * *finite_number(stem.substr(11));
}

/// A date and a time of day at the end, with or without marks between their numbers.
std::optional<double> date_time(const std::string& stem) {
  const std::size_t from = stem.find_first_of(digits);
  if (from == std::string::npos) return std::nullopt;
  std::string joined;
  for (std::size_t i = from; i < stem.size(); ++i) {
    const char c = stem[i];
    const bool is_mark = c == '-' || c == '_' || c == '.' || c == ':' || c == 'T' || c == ' ';
    if (c >= '0' && c <= '9')
      joined += c;
    else if (!is_mark)
      return std::nullopt;
  }
  if (joined.size() < 14 || joined.size() > 23) return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t count) { return std::stoi(joined.substr(at, count)); };
  const int year = number(0, 4);
  if (year < 1970 || year > 2199) return std::nullopt;
  const auto whole =
      seconds_of_date(year, number(4, 2), number(6, 2), number(8, 2), number(10, 2), number(12, 2));
  if (!whole) return std::nullopt;
  return joined.size() == 14 ? *whole : *whole + *finite_number("0." + joined.substr(14));
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
  const auto number = finite_number(stem);
  if (!number || stem.find_first_not_of(digits) == std::string::npos)
    if (const auto date = date_time(stem)) return date;
  if (number) return number;
  if (const auto time = redwood_time(stem)) return time;
  if (const auto time = stamp_time(stem)) return time;
  std::string end = stem.substr(stem.find_last_not_of(digits_and_point) + 1);
  end.erase(0, end.find_first_not_of('.'));
  std::string beginning = stem.substr(0, stem.find_first_not_of(digits_and_point));
  beginning.erase(beginning.find_last_not_of('.') + 1);
  for (const std::string& text : {end, beginning}) {
    const std::size_t whole = std::min(text.find('.'), text.size());
    const bool is_clock = whole < text.size() ? whole == 10 : whole == 13 || whole == 16 || whole == 19;
    if (is_clock)
      if (const auto clock = finite_number(text)) return clock;
  }
  return std::nullopt;
}

}  // namespace clearway
