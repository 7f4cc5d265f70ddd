#include "datasets/ros/bag_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "datasets/ros/cut_bag.hpp"
#include "datasets/ros/transform_faults.hpp"
#include "datasets/sources/clock_restart.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

/// The end of the clause about a clock that was set back.
std::string ways_out(std::optional<double> cut, bool came_first, const char* recording) {
  const std::string seconds = cut ? short_text(*cut, 12) : "";
  const std::string cuts = cut ? (came_first ? "`from: " : "`to: ") + seconds + "` takes what was before, `" +
                                     (came_first ? "to: " : "from: ") + seconds + "` what came after, "
                               : "";
  return "; in `source: {bag: …}` of the setup " + cuts + recording +
         "`times: stamps` takes all in the order of the stamps, where they are right";
}

}  // namespace

void BagClocks::note(const std::string& name, double stamp, const BagMessage& message) {
  streams_[name].push_back({stamp, message.time, message.place});
}

std::vector<double> BagClocks::stamps_of(const Stream& stream) {
  std::vector<double> stamps;
  for (const Message& message : stream) stamps.push_back(message.stamp);
  return stamps;
}

std::vector<double> BagClocks::recordings_of(const Stream& stream) {
  std::vector<double> times;
  for (const Message& message : stream) times.push_back(message.recorded);
  return times;
}

BagClocks::Stream BagClocks::by_place(Stream stream) {
  std::stable_sort(stream.begin(), stream.end(),
                   [](const Message& a, const Message& b) { return a.place < b.place; });
  return stream;
}

void BagClocks::refuse_restarts(double first_time) const {
  std::string clause;
  double first = HUGE_VAL;
  for (const auto& [name, stream] : streams_) {
    const std::vector<double> stamps = stamps_of(stream), recorded = recordings_of(stream);
    const auto restart = find_restart(stamps);
    if (!restart || recorded[*restart] >= first) continue;
    first = recorded[*restart];
    clause = restart_clause(name, stamps, "the stamps", *restart, cut_before(recorded, *restart, first_time));
  }
  if (!clause.empty()) throw ContradictoryBag(clause);
  for (const auto& [name, stream] : streams_) {
    const std::vector<double> times = recordings_of(by_place(stream));
    if (const auto restart = find_restart(times))
      throw ContradictoryBag(restart_clause(name, times, "the times of recording", *restart, {}));
  }
}

/// Messages that lie in a file in any order, as of a program that shuffled it.
bool BagClocks::is_file_in_order() const {
  return std::all_of(streams_.begin(), streams_.end(), [](const auto& named) {
    const std::vector<double> times = recordings_of(by_place(named.second));
    return is_one_run(times) || find_set_back(times);
  });
}

void BagClocks::refuse_set_back(double first_time) const {
  const bool is_in_order = is_file_in_order();
  for (const auto& [name, stream] : streams_) {
    const std::vector<double> stamps = stamps_of(stream), recorded = recordings_of(stream);
    const Stream written = by_place(stream);
    // A recorder's clock that was set back changes the order of recording, and no stamp.
    const bool is_recorders = !is_one_run(recordings_of(written)) && is_one_run(stamps_of(written));
    const auto step = is_recorders ? std::nullopt : find_set_back(stamps);
    if (step)
      throw ContradictoryBag(
          "holds more than one run of its clock: " + set_back_clause(name, stamps, "the stamps", *step) +
          ways_out(cut_before(recorded, *step, first_time), false,
                   "`times: recording` takes all at the times of its recording, "));
    if (is_in_order && !is_recorders) refuse_set_back(name, written, first_time);
  }
}

void BagClocks::refuse_set_back(const std::string& name, const Stream& written, double first_time) {
  // Of each file alone: those of a folder are in no order that anything states.
  for (auto begin = written.begin(); begin != written.end();) {
    const auto end = std::find_if(begin, written.end(), [&](const Message& message) {
      return message.place.part != begin->place.part;
    });
    const std::vector<double> times = recordings_of({begin, end});
    if (const auto step = find_set_back(times)) {
      std::vector<double> later(times.begin() + static_cast<std::ptrdiff_t>(*step), times.end());
      const std::size_t after = later.size();
      later.insert(later.end(), times.begin(), times.begin() + static_cast<std::ptrdiff_t>(*step));
      throw ContradictoryBag("holds more than one run of its clock: " +
                             set_back_clause(name, times, "the times of recording", *step) +
                             ways_out(cut_before(later, after, first_time), true, ""));
    }
    begin = end;
  }
}

}  // namespace clearway
