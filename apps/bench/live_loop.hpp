#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "apps/bench/bench.hpp"
#include "planning/constraint/live_control.hpp"

namespace clearway::bench {

/// One turn of a control loop. Times in seconds of the steady clock, or of this thread's CPU time.
struct LoopTurn {
  double begin = 0.0, end = 0.0;            ///< of fetching and stepping
  double fetch = 0.0, fetch_cpu = 0.0;      ///< how long fetching held it
  double cpu = 0.0;                         ///< fetching and stepping
  double age = 0.0;                         ///< of the map that it stepped with
  std::uint32_t number = 0, places = 0;     ///< of the map; bit k: a constraint has the fist at place k
  bool is_new = false, is_braking = false;  ///< the first with this map
};

/// A loop that lets an arm sway between two configurations, and puts it back to the first every 400 turns:
/// what turned up may have pushed it away.
struct LoopTask {
  Configuration one, other;
  std::vector<Sphere> places;  ///< whose constraints are looked for
  double resolution = 0.02;
  double period = 0.0;    ///< s; 0: without a pause
  double duration = 1.0;  ///< s
};

/// What it did, and what the scheduler did with it.
struct LoopLog {
  std::vector<LoopTurn> turns;
  long involuntary_switches = 0;
  bool is_real_time = false;  ///< SCHED_FIFO was granted
};

/// Seconds of the steady clock, as LiveControl has them.
double steady_seconds();
LiveControl::Time steady_time(double seconds);

/// Runs the loop on this thread; `before_turn` is called ahead of each turn, outside its times.
/// @param real_time asks for SCHED_FIFO until it returns
LoopLog run_loop(
    LiveControl& live, const LoopTask& task, bool real_time,
    const std::function<void()>& before_turn = [] {});

/// Median, p99 and max, in microseconds of seconds.
nlohmann::ordered_json microseconds(const std::vector<double>& seconds);

/// Times of the turns, of those that took over a map, ages and what the scheduler did.
nlohmann::ordered_json reported(const LoopLog& log);

}  // namespace clearway::bench
