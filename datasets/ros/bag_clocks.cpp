#include "datasets/ros/bag_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "datasets/ros/cut_bag.hpp"
#include "datasets/ros/transform_faults.hpp"
#include "datasets/sources/clock_restart.hpp"

namespace clearway {

void BagClocks::refuse_restarts(double first_time) const {
  std::string clause;
  double first = HUGE_VAL;
  for (const auto& [name, stream] : streams_) {
    std::vector<double> recorded;
    for (const auto& [place, time] : stream.recorded) recorded.push_back(time);
    const auto restart = find_restart(stream.stamps);
    if (!restart || recorded[*restart] >= first) continue;
    first = recorded[*restart];
    clause = restart_clause(name, stream.stamps, "the stamps", *restart,
                            cut_before(recorded, *restart, first_time));
  }
  if (!clause.empty()) throw ContradictoryBag(clause);
  for (const auto& [name, stream] : streams_) {
    auto recorded = stream.recorded;
    std::stable_sort(recorded.begin(), recorded.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<double> times;
    for (const auto& [place, time] : recorded) times.push_back(time);
    if (const auto restart = find_restart(times))
      throw ContradictoryBag(restart_clause(name, times, "the times of recording", *restart, {}));
  }
}

}  // namespace clearway
