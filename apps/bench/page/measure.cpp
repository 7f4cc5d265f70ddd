#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "apps/bench/page/measure.hpp"

#include "apps/console/quantile.hpp"

namespace clearway::bench {

double median(std::vector<double> values) { return values.empty() ? 0.0 : quantile(std::move(values), 0.5); }

double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds(const std::function<void()>& work) {
  const double begin = cpu_time();
  work();
  return cpu_time() - begin;
}

void settle_heap() {
  std::vector<std::vector<char>> blocks(64);
  for (std::vector<char>& block : blocks) block.reserve(100000);
}

Pair interleave(const BenchOptions& options, const std::function<double()>& ours,
                const std::function<double()>& peer) {
  std::vector<double> first, second;
  for (int run = 0; run < options.runs; ++run) {
    options.say_run(run, options.runs);
    first.push_back(ours());
    second.push_back(peer());
  }
  return {median(first), median(second)};
}

}  // namespace clearway::bench
