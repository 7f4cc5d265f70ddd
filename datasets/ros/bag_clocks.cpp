#include "datasets/ros/bag_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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

constexpr double most_apart = 1.0;     ///< s, that is not told: recorders hold messages back
constexpr double most_late = 5.0;      ///< s, that drivers, networks and dates in advance may account for
constexpr double longest_work = 10.0;  ///< s, that programs may need for a pose
constexpr double steady = 0.5;         ///< s, by which the distance of two clocks varies at most
constexpr std::size_t fewest = 3;      ///< messages that say what a stream is like

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of the middle half of the values.
double spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() * 3 / 4] - values[values.size() / 4];
}

/// With thousandths, also of a clock that counts from another year.
std::string seconds_text(double seconds) { return short_text(std::round(1e3 * seconds) / 1e3, 13); }

std::string offset_text(const BagClocks::Offset& offset) {
  return "by their times of recording, the stamps of " + offset.name + " are " +
         seconds_text(std::abs(offset.ahead)) + " s " + (offset.ahead > 0.0 ? "ahead of" : "behind") +
         " those of " + offset.other;
}

/// What can be done about clocks that differ. @param moves whether the topic of the first can be moved alone
std::string ways_out(const BagClocks::Offset& offset, bool moves) {
  return "; in `source: {bag: …}` of the setup `times: stamps` takes all as they are, where one only comes "
         "late" +
         (moves ? "; where its clock differs, `clock_offsets: [{topic: " +
                      offset.name.substr(1, offset.name.size() - 2) +
                      ", add: " + seconds_text(-offset.ahead) + "}]` moves it"
                : std::string());
}

std::string doubt(const BagClocks::Offset& offset, bool moves) {
  return "may be stamped by clocks that differ: " + offset_text(offset) + ways_out(offset, moves);
}

[[noreturn]] void refuse(const BagClocks::Offset& offset, const char* what, bool moves) {
  throw ContradictoryBag("is stamped by clocks that differ: " + offset_text(offset) + ", so that " + what +
                         ways_out(offset, moves));
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

std::vector<std::string> BagClocks::names() const {
  std::vector<std::string> names;
  for (const auto& [name, stream] : streams_) names.push_back(name);
  return names;
}

std::optional<BagClocks::Offset> BagClocks::offset_between(const std::string& name,
                                                           const std::string& other) const {
  const auto a = streams_.find(name), b = streams_.find(other);
  if (a == streams_.end() || b == streams_.end() || a->second.size() < fewest || b->second.size() < fewest)
    return std::nullopt;
  Stream one = a->second, two = b->second;
  const auto by_recording = [](const Message& x, const Message& y) { return x.recorded < y.recorded; };
  for (Stream* stream : {&one, &two}) std::stable_sort(stream->begin(), stream->end(), by_recording);
  for (const Stream& stream : {one, two})  // as of converters, which say nothing of when it came
    if (stream.front().recorded == stream.back().recorded) return std::nullopt;
  std::vector<double> aheads;
  for (const Message& message : one) {
    const auto after = std::lower_bound(two.begin(), two.end(), message, by_recording);
    if (after == two.end() || (after == two.begin() && after->recorded > message.recorded)) continue;
    const Message& before = after == two.begin() ? *after : *std::prev(after);
    const double span = after->recorded - before.recorded,
                 part = span > 0.0 ? (message.recorded - before.recorded) / span : 0.0;
    aheads.push_back(message.lead() - before.lead() - part * (after->lead() - before.lead()));
  }
  // Of batches, of programs that fall behind, and of what was recorded apart it cannot be told.
  if (aheads.size() < fewest || spread(aheads) > steady) return std::nullopt;
  const double ahead = median(aheads);
  if (std::abs(ahead) <= most_apart) return std::nullopt;
  const auto [first, last] = std::minmax_element(
      two.begin(), two.end(), [](const Message& x, const Message& y) { return x.stamp < y.stamp; });
  const bool do_overlap = std::any_of(one.begin(), one.end(), [&](const Message& message) {
    return message.stamp >= first->stamp && message.stamp <= last->stamp;
  });
  return Offset{name, other, ahead, do_overlap};
}

std::vector<std::string> BagClocks::refuse_offsets(const std::vector<std::string>& sensors) const {
  std::vector<std::string> told;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto offset = offset_between(sensors[i], sensors[j]);
      if (!offset) continue;
      if (std::abs(offset->ahead) > most_late)
        refuse(*offset, "what one saw last may count as seen before what the other did", true);
      told.push_back(doubt(*offset, true));
    }
  return told;
}

std::vector<std::string> BagClocks::refuse_pose_offsets(const std::vector<std::string>& sensors,
                                                        const std::vector<std::string>& poses) const {
  std::vector<std::string> told;
  for (const std::string& pose : poses)
    for (const std::string& sensor : sensors) {
      const auto offset = offset_between(pose, sensor);
      if (!offset || !offset->do_overlap) continue;
      if (offset->ahead > most_late || offset->ahead < -longest_work)
        refuse(*offset, "it may be placed by poses of another moment", false);
      told.push_back(doubt(*offset, false));
    }
  return told;
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

void BagClocks::refuse_set_back(const std::vector<std::string>& names, double first_time) const {
  const bool is_in_order = is_file_in_order();
  for (const std::string& name : names) {
    const auto found = streams_.find(name);
    if (found == streams_.end()) continue;
    const Stream& stream = found->second;
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
