#include "datasets/sources/clock_restart.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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

/// Whether a run that no message is much behind goes on, and not back or to and fro within that.
bool is_increasing(std::span<const double> run) {
  const auto [first, last] = std::minmax_element(run.begin(), run.end());
  if (*last - *first > 2.0 * least_jump) return true;
  double forth = 0.0, back = 0.0;
  for (std::size_t i = 1; i < run.size(); ++i)
    (run[i] < run[i - 1] ? back : forth) += std::abs(run[i] - run[i - 1]);
  return forth >= 2.0 * back;
}

/// Whether the messages from `step` on are those that lack before it, as late ones do: each lies in a gap of
/// more than one and a half of the usual spacing.
bool fill_gaps(std::span<const double> times, std::size_t step) {
  constexpr double latest = 10.0, of_usual = 1.5;  // s, 1
  std::vector<double> before(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(step)), spacings;
  std::sort(before.begin(), before.end());
  for (std::size_t i = 1; i < before.size(); ++i) spacings.push_back(before[i] - before[i - 1]);
  if (spacings.size() < 3) return false;
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return std::all_of(times.begin() + static_cast<std::ptrdiff_t>(step), times.end(), [&](double time) {
    const auto after = std::lower_bound(before.begin(), before.end(), time);
    return after != before.begin() && after != before.end() && before.back() - time <= latest &&
           *after - *std::prev(after) > of_usual * *middle;
  });
}

/// "the stamps of NAME jump back by 3 s at message 62 of 122"
std::string jump_text(const std::string& name, std::span<const double> times, const char* what,
                      std::size_t jump) {
  const auto at = times.begin() + static_cast<std::ptrdiff_t>(jump);
  return std::string(what) + " of " + name + " jump back by " +
         short_text(*std::max_element(times.begin(), at) - *at) + " s at message " +
         std::to_string(jump + 1) + " of " + std::to_string(times.size());
}

}  // namespace

bool is_one_run(std::span<const double> times) { return begins_of_runs(times).size() <= 1; }

std::optional<std::size_t> find_set_back(std::span<const double> times) {
  constexpr std::size_t fewest = 3;  // one or two may be a driver's wrong stamps
  std::vector<std::size_t> begins = begins_of_runs(times);
  if (begins.size() < 2 || begins.size() - 1 > std::max<std::size_t>(1, times.size() / 8))
    return std::nullopt;
  begins.push_back(times.size());
  std::optional<std::size_t> step;
  double reached = -HUGE_VAL;
  for (std::size_t run = 0; run + 1 < begins.size(); ++run) {
    const auto of_run = times.subspan(begins[run], begins[run + 1] - begins[run]);
    if (!is_increasing(of_run)) return std::nullopt;
    std::vector<double> latest(of_run.begin(), of_run.end());
    std::sort(latest.rbegin(), latest.rend());
    if (latest.front() >= reached)
      step.reset();
    else if (!step)
      step = begins[run];
    reached = std::max(reached, latest[latest.size() < fewest ? 0 : fewest - 1]);
  }
  if (step && (*step < fewest || times.size() - *step < fewest || fill_gaps(times, *step)))
    return std::nullopt;
  return step;
}

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
  const std::string seconds = cut ? short_text(*cut, 12) : "";
  const std::string way_out =
      cut ? "`to: " + seconds +
                "` in `source: {bag: …}` of the setup takes what was before, `from: " + seconds +
                "` what came after"
          : "`ros2 bag convert` or `rosbag filter` cuts it to one";
  return "holds more than one run of its clock: " + jump_text(name, times, what, restart) +
         ", and pass the same times again, so that nothing says which poses belong to which scans; expected "
         "one run: " +
         way_out;
}

std::string set_back_clause(const std::string& name, std::span<const double> times, const char* what,
                            std::size_t step) {
  return jump_text(name, times, what, step) +
         ", as of a clock that was set back: what was seen last would count as seen first";
}

}  // namespace clearway
