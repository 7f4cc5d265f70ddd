#include "apps/check/trajectory_entries.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/check/trajectory_plan.hpp"
#include "apps/console/parse.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double begins_within = 1e-4;  ///< rad or m
constexpr double halts_within = 1e-6;   ///< rad/s or m/s

/// What messages call an entry.
std::string place_of(const std::filesystem::path& file, const ForeignTrajectory& entry) {
  return entry.field.empty() ? file.string() : file.string() + ": " + entry.field;
}

[[noreturn]] void refuse_entry(const std::filesystem::path& file, const ForeignTrajectory& entry,
                               const std::string& what) {
  throw std::invalid_argument(place_of(file, entry) + ": " + what);
}

void require_begin(const ForeignTrajectory& entry, const std::map<std::string, double>& state,
                   const std::filesystem::path& file) {
  for (std::size_t j = 0; j < entry.joints.size(); ++j) {
    const double begin = entry.points.front()[j], end = state.at(entry.joints[j]);
    if (std::abs(begin - end) > begins_within)
      refuse_entry(file, entry,
                   "begins with joint " + quote(entry.joints[j]) + " at " + significant(begin, 7) +
                       ", expected it at " + significant(end, 7) + ", where the ones before leave it");
  }
}

/// At its first or its last point. Accelerations may be there: MoveIt's timing leaves some at the end.
void require_rest(const ForeignTrajectory& entry, bool at_end, const std::filesystem::path& file) {
  if (entry.velocities.empty()) return;
  const std::vector<double>& rates = at_end ? entry.velocities.back() : entry.velocities.front();
  for (std::size_t j = 0; j < rates.size(); ++j)
    if (std::abs(rates[j]) > halts_within)
      refuse_entry(file, entry,
                   "moves joint " + quote(entry.joints[j]) + " at its " + (at_end ? "last" : "first") +
                       " point, expected velocities of 0: each is executed from rest to rest");
}

/// Where each joint is before all of them.
std::map<std::string, double> state_before(const std::vector<ForeignTrajectory>& entries) {
  std::map<std::string, double> state = entries.front().start;
  for (const ForeignTrajectory& entry : entries)
    for (std::size_t j = 0; j < entry.joints.size(); ++j)
      state.insert({entry.joints[j], entry.points.front()[j]});
  return state;
}

}  // namespace

void join_entries(std::vector<ForeignTrajectory>& entries, const std::filesystem::path& file) {
  if (entries.size() < 2) return;
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].field = "trajectory[" + std::to_string(i) + "]";
  const bool have_times = std::any_of(entries.begin(), entries.end(),
                                      [](const ForeignTrajectory& entry) { return !entry.times.empty(); });
  std::map<std::string, double> state = state_before(entries);
  for (const auto& [name, value] : state) {
    const std::vector<std::string>& first = entries.front().joints;
    if (std::find(first.begin(), first.end(), name) == first.end()) entries.front().start[name] = value;
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    ForeignTrajectory& entry = entries[i];
    if (have_times && entry.times.empty() && entry.points.size() > 1)
      refuse_entry(file, entry, "has no times, expected time_from_start as others have it");
    if (i > 0) {
      require_begin(entry, state, file);
      require_rest(entry, false, file);
      entry.start = state;
    }
    if (i + 1 < entries.size()) require_rest(entry, true, file);
    for (std::size_t j = 0; j < entry.joints.size(); ++j) state[entry.joints[j]] = entry.points.back()[j];
  }
}

Plan plan_of_trajectories(const std::vector<ForeignTrajectory>& entries, const Robot& robot,
                          const std::filesystem::path& file) {
  Plan plan = plan_of_trajectory(entries.front(), robot, place_of(file, entries.front()));
  std::vector<Configuration>& path = plan.legs.front().waypoints;
  for (std::size_t i = 1; i < entries.size(); ++i)
    for (const Configuration& q :
         plan_of_trajectory(entries[i], robot, place_of(file, entries[i])).waypoints())
      if (q != path.back()) path.push_back(q);
  plan.goals = {path.back()};
  return plan;
}

std::vector<TimedTrajectory> timed_trajectories(const std::vector<ForeignTrajectory>& entries,
                                                const Robot& robot, const std::filesystem::path& file) {
  std::vector<TimedTrajectory> all;
  for (const ForeignTrajectory& entry : entries)
    if (std::optional<TimedTrajectory> timed = timed_trajectory(entry, robot, place_of(file, entry)))
      all.push_back(std::move(*timed));
  return all;
}

SplineVerdict check_timed(const std::vector<TimedTrajectory>& entries, const Robot& robot,
                          const Snapshot& map, const std::map<std::string, Policy>& policies, double padding,
                          double seen_within) {
  const auto judge = [&](const TimedTrajectory& entry) {
    SplineVerdict verdict = check_timed(entry, robot, map, policies, padding, seen_within);
    for (auto* peak : {&verdict.free_velocity, &verdict.free_acceleration, &verdict.jerk})
      if (*peak) (*peak)->part = entry.field;
    return verdict;
  };
  SplineVerdict all = judge(entries.front());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i > 0) {
      const SplineVerdict next = judge(entries[i]);
      const double clearance = std::min(all.path.min_clearance, next.path.min_clearance);
      all.path = next.path;
      all.path.min_clearance = clearance;
      all.fault = next.fault;
      all.velocity_share = std::max(all.velocity_share, next.velocity_share);  // none is below all
      all.acceleration_share = std::max(all.acceleration_share, next.acceleration_share);
      raise_peaks(all, next);
      all.lines += next.lines;
      all.cubics += next.cubics;
      all.quintics += next.quintics;
      all.chords.insert(all.chords.end(), next.chords.begin(), next.chords.end());
    }
    if (all.is_valid()) continue;
    for (std::string* sentence : {&all.fault, &all.path.first_contact})
      if (!sentence->empty() && !entries[i].field.empty()) *sentence = entries[i].field + ": " + *sentence;
    break;
  }
  return all;
}

TorqueFinding torques_of(const std::vector<TimedTrajectory>& entries, const Robot& robot,
                         const JointLoad& load, SplineVerdict& verdict) {
  TorqueFinding greatest;
  for (std::size_t i = 0; i < entries.size() && verdict.fault.empty(); ++i) {
    const TorqueFinding found = torques_of(entries[i], robot, load, verdict);
    if (i == 0 || !verdict.fault.empty() || found.share > greatest.share) greatest = found;
    if (!verdict.fault.empty() && !entries[i].field.empty())
      verdict.fault = entries[i].field + ": " + verdict.fault;
  }
  return greatest;
}

std::vector<std::string> notes_of(const std::vector<TimedTrajectory>& entries, const SplineVerdict& verdict) {
  std::vector<std::string> notes;
  for (const TimedTrajectory& entry : entries)
    for (const std::string& note : notes_of(entry, verdict))
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  return notes;
}

double duration_of(const std::vector<TimedTrajectory>& entries) {
  double sum = 0.0;
  for (const TimedTrajectory& entry : entries) sum += entry.points.back().time;
  return sum;
}

}  // namespace clearway
