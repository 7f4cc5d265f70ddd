#include "datasets/sources/clock_restart.hpp"

#include <algorithm>
#include <vector>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

constexpr double least_jump = 1.0;  ///< s, back
constexpr std::ptrdiff_t least_repeated = 3;

/// Where the stream begins, and each place at which it is behind what it had reached by more than a jump.
std::vector<std::size_t> begins_of_runs(std::span<const double> times) {
  std::vector<std::size_t> begins;
  double reached = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool begins_here = i == 0 || times[i] < reached - least_jump;
    if (begins_here) begins.push_back(i);
    reached = begins_here ? times[i] : std::max(reached, times[i]);
  }
  return begins;
}

/// Whether the stream goes back as often and far as without any order: messages that are drawn at random go
/// back by a sixth of the span each.
bool is_without_order(std::span<const double> times, std::size_t runs) {
  if (times.empty()) return true;
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  double back = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) back += std::max(0.0, times[i - 1] - times[i]);
  const double messages = static_cast<double>(times.size());
  return runs > std::max<std::size_t>(3, times.size() / 4) ||
         back > (*last - *first) * std::max(3.0, messages / 10.0);
}

}  // namespace

std::optional<std::size_t> find_restart(std::span<const double> times) {
  const std::vector<std::size_t> begins = begins_of_runs(times);
  if (is_without_order(times, begins.size())) return std::nullopt;
  for (std::size_t run = 1; run < begins.size(); ++run) {
    const auto past = times.first(begins[run]);
    const double first = *std::min_element(past.begin(), past.end()),
                 last = *std::max_element(past.begin(), past.end());
    const std::size_t end = run + 1 < begins.size() ? begins[run + 1] : times.size();
    const auto of_run = times.subspan(begins[run], end - begins[run]);
    const auto repeated = std::count_if(of_run.begin(), of_run.end(),
                                        [&](double time) { return first <= time && time <= last; });
    if (repeated >= least_repeated) return begins[run];
  }
  return std::nullopt;
}

std::string restart_clause(const std::string& name, std::span<const double> times, const char* what,
                           std::size_t restart, std::optional<double> cut) {
  const auto at = times.begin() + static_cast<std::ptrdiff_t>(restart);
  const std::string seconds = cut ? short_text(*cut, 12) : "";
  const std::string way_out =
      cut ? "`to: " + seconds +
                "` in `source: {bag: …}` of the setup takes what was before, `from: " + seconds +
                "` what came after"
          : "`ros2 bag convert` or `rosbag filter` cuts it to one";
  return "holds more than one run of its clock: " + std::string(what) + " of " + name + " jump back by " +
         short_text(*std::max_element(times.begin(), at) - *at) + " s at message " +
         std::to_string(restart + 1) + " of " + std::to_string(times.size()) +
         ", and pass the same times again, so that nothing says which poses belong to which scans; expected "
         "one run: " +
         way_out;
}

}  // namespace clearway
