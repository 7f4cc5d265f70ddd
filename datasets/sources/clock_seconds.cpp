#include "datasets/sources/clock_seconds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clearway {

void make_seconds(std::vector<double>& times) {
  const double largest = times.empty() ? 0.0 : *std::max_element(times.begin(), times.end());
  for (const auto& [from, unit] : {std::pair{1e12, 1e-3}, std::pair{1e15, 1e-6}, std::pair{1e18, 1e-9}})
    if (largest >= from && largest < 10.0 * from)
      for (double& time : times) time *= unit;
}

std::optional<std::size_t> of_another_unit(const std::vector<double>& times) {
  constexpr double apart = 500.0;  // units are a thousand apart
  std::vector<double> seconds = times;
  make_seconds(seconds);
  const auto first = std::lower_bound(times.begin(), times.end(), clock_begins);
  if (seconds.back() == times.back() || *first > times.back() / apart) return std::nullopt;
  return static_cast<std::size_t>(first - times.begin());
}

bool count_from_zero(const std::vector<double>& times) {
  constexpr double some_years = 1e8, some_months = 1e7;  // s
  if (times.size() < 3 || times.back() >= 1e12) return false;
  const double span = times.back() - times.front();
  const bool are_sparse = span > some_months * static_cast<double>(times.size() - 1);
  return span > some_years && (times.front() < clock_begins || are_sparse) &&
         std::all_of(times.begin(), times.end(), [](double time) { return time == std::floor(time); });
}

std::vector<double> finer_than_seconds(std::vector<double> times) {
  const double apart = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (double& time : times) time *= apart >= 1e6 ? 1e-9 : 1e-6;
  return times;
}

}  // namespace clearway
