#include "apps/results/compare_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace clearway {
namespace {

using Run = CompareRun;
using Who = ComparePlanner;
using Cell = CompareCell;

std::int64_t whole(std::uint64_t value) { return static_cast<std::int64_t>(value); }

/// Nothing for teams, which plan nothing beforehand.
std::function<Cell(const Run&, const Who&)> of_planning(double Run::*seconds) {
  return [seconds](const Run& run, const Who&) -> Cell { return run.team ? Cell{} : Cell{run.*seconds}; };
}

/// What of the time to plan was spent on one kind of work; nothing where it is not known, or there was none.
RunColumn of_work(const char* name, std::optional<double> WorkTimes::*seconds) {
  return {name, "REAL", [seconds](const Run& run, const Who&) -> Cell {
            const std::optional<double>& spent = run.work.*seconds;
            return spent ? Cell(*spent) : Cell();
          }};
}

/// What every run has.
std::vector<RunColumn> common_columns() {
  return {
      {"run", "INTEGER", [](const Run& run, const Who&) -> Cell { return std::int64_t{run.number}; }},
      {"seed", "TEXT", [](const Run& run, const Who&) -> Cell { return std::to_string(run.seed); }},
      {"label", "TEXT", [](const Run&, const Who& who) -> Cell { return who.label; }},
      {"planner", "TEXT", [](const Run&, const Who& who) -> Cell { return who.planner; }},
      {"options", "TEXT",
       [](const Run&, const Who& who) -> Cell { return nlohmann::ordered_json(who.options).dump(); }},
      {"certified", "INTEGER", [](const Run&, const Who& who) -> Cell { return whole(who.certified); }},
      {"status", "TEXT", [](const Run& run, const Who&) -> Cell { return run.outcome(); }},
      {"solved", "INTEGER", [](const Run& run, const Who&) -> Cell { return whole(run.is_solved()); }},
      {"valid", "INTEGER", [](const Run& run, const Who&) -> Cell { return whole(run.is_valid()); }},
      {"check", "TEXT", [](const Run& run, const Who&) -> Cell { return run.check; }},
      {"legs", "INTEGER", [](const Run& run, const Who&) -> Cell { return whole(run.legs); }},
      {"cost_joules", "REAL",
       [](const Run& run, const Who&) -> Cell { return std::isnan(run.cost) ? Cell() : Cell(run.cost); }},
      {"length_rad", "REAL", [](const Run& run, const Who&) -> Cell { return run.length; }},
      {"steps", "INTEGER", [](const Run& run, const Who&) -> Cell { return whole(run.steps); }},
      {"waypoints", "INTEGER", [](const Run& run, const Who&) -> Cell { return whole(run.waypoints); }},
      {"min_clearance_m", "REAL", [](const Run& run, const Who&) -> Cell { return run.min_clearance; }},
      {"configurations", "INTEGER",
       [](const Run& run, const Who&) -> Cell { return whole(run.configurations); }},
      {"edges", "INTEGER", [](const Run& run, const Who&) -> Cell { return whole(run.edges); }},
      {"time_s", "REAL", [](const Run& run, const Who&) -> Cell { return run.time; }},
      {"cpu_s", "REAL", of_planning(&Run::cpu)},
      of_work("search_cpu_s", &WorkTimes::search),
      of_work("shortcut_cpu_s", &WorkTimes::shortcuts),
      of_work("proof_cpu_s", &WorkTimes::proofs),
      {"space_cpu_s", "REAL", of_planning(&Run::space_cpu)},
      {"derive_cpu_s", "REAL", of_planning(&Run::derive_cpu)},
      {"check_s", "REAL", of_planning(&Run::check_time)},
      {"check_cpu_s", "REAL", of_planning(&Run::check_cpu)},
      {"motion_cpu_s", "REAL", of_planning(&Run::motion_cpu)},
      {"plan", "TEXT", [](const Run& run, const Who&) -> Cell { return run.plan_file; }},
      {"contact", "TEXT", [](const Run& run, const Who&) -> Cell { return run.contact; }},
      {"explanation", "TEXT", [](const Run& run, const Who&) -> Cell { return run.explanation; }},
  };
}

/// What a motion in time has.
RunColumn of_motion(const char* name, double CompareMotion::*value) {
  return {name, "REAL", [value](const Run& run, const Who&) {
            return run.motion && !std::isnan(*run.motion.*value) ? Cell(*run.motion.*value) : Cell();
          }};
}

std::vector<RunColumn> motion_columns() {
  return {of_motion("motion_time_s", &CompareMotion::time),
          of_motion("speed_share", &CompareMotion::speed),
          of_motion("acceleration_share", &CompareMotion::acceleration),
          of_motion("jerk_share", &CompareMotion::jerk),
          {"motion_note", "TEXT", [](const Run& run, const Who&) {
             return run.motion && !run.team ? Cell(run.motion->note) : Cell();
           }}};
}

/// What teams alone have; nothing of those that never moved.
RunColumn of_team(const char* name, double CompareTeamRun::*value) {
  return {name, "REAL", [value](const Run& run, const Who&) {
            return run.team && run.check != "none" ? Cell(*run.team.*value) : Cell();
          }};
}

std::vector<RunColumn> team_columns() {
  return {
      {"safe", "INTEGER",
       [](const Run& run, const Who&) { return run.team ? Cell(whole(run.check == "valid")) : Cell(); }},
      {"outrun", "TEXT",
       [](const Run& run, const Who&) { return run.team ? Cell(run.team->outrun) : Cell(); }},
      of_team("step_bound_m", &CompareTeamRun::step_bound),
      of_team("obstacle_speed_m_s", &CompareTeamRun::obstacle_speed),
      of_team("between_robots_m", &CompareTeamRun::between_robots),
  };
}

/// Statistics that planners and teams report under these names, and how those of several legs are joined.
struct Statistic {
  const char* name;
  enum Joined { added, least, largest } joined;
};

constexpr std::array statistics = {Statistic{"influence_distance_m", Statistic::largest},
                                   Statistic{"security_distance_m", Statistic::largest},
                                   Statistic{"xi_m", Statistic::largest},
                                   Statistic{"max_step", Statistic::largest},
                                   Statistic{"least_separation_m", Statistic::least},
                                   Statistic{"steps_local", Statistic::added},
                                   Statistic{"steps_boundary", Statistic::added},
                                   Statistic{"deadlocks", Statistic::added},
                                   Statistic{"constraint_switches", Statistic::added},
                                   Statistic{"steps_relaxed", Statistic::added},
                                   Statistic{"steps_shortened", Statistic::added},
                                   Statistic{"steps_over_acceleration", Statistic::added},
                                   Statistic{"planes_tried", Statistic::added},
                                   Statistic{"hand_over_rounds", Statistic::added},
                                   Statistic{"handed_back", Statistic::added},
                                   Statistic{"samples", Statistic::added},
                                   Statistic{"sampled_share", Statistic::largest},
                                   Statistic{"sharpest_turn_rad", Statistic::largest}};

RunColumn of_statistic(const Statistic& statistic) {
  const std::string name = statistic.name;
  const bool is_count = statistic.joined == Statistic::added;
  return {name, is_count ? "INTEGER" : "REAL", [name, is_count](const Run& run, const Who&) -> Cell {
            const auto found = run.statistics.find(name);
            if (found == run.statistics.end()) return {};
            if (is_count) return static_cast<std::int64_t>(found->second);
            return found->second;
          }};
}

/// Which stage of `boundary_plus` joined start and goal, of several legs the last one that was needed.
RunColumn stage_column() {
  return {"solved_by", "TEXT", [](const Run& run, const Who&) -> Cell {
            if (!run.solved_by) return {};
            return std::string(to_string(*run.solved_by));
          }};
}

RunColumn handed_over() {
  return {"handed_over", "INTEGER", [](const Run& run, const Who&) -> Cell {
            const auto found = run.statistics.find("hand_over_rounds");
            if (found == run.statistics.end()) return {};
            return whole(found->second > 0.0);
          }};
}

void join(std::map<std::string, double>& all, const Statistic& statistic, const PlanResult& leg) {
  const auto reported = leg.statistics.find(statistic.name);
  if (reported == leg.statistics.end()) return;
  const auto [place, is_first] = all.try_emplace(statistic.name, reported->second);
  if (is_first) return;
  double& value = place->second;
  if (statistic.joined == Statistic::added) value += reported->second;
  if (statistic.joined == Statistic::least) value = std::min(value, reported->second);
  if (statistic.joined == Statistic::largest) value = std::max(value, reported->second);
}

}  // namespace

const std::vector<RunColumn>& run_columns() {
  static const std::vector<RunColumn> columns = [] {
    std::vector<RunColumn> all = common_columns();
    for (RunColumn& column : motion_columns()) all.push_back(std::move(column));
    for (RunColumn& column : team_columns()) all.push_back(std::move(column));
    for (const Statistic& statistic : statistics) all.push_back(of_statistic(statistic));
    all.push_back(stage_column());
    all.push_back(handed_over());
    return all;
  }();
  return columns;
}

std::map<std::string, double> column_statistics(const std::vector<PlanResult>& legs) {
  std::map<std::string, double> all;
  for (const PlanResult& leg : legs)
    for (const Statistic& statistic : statistics) join(all, statistic, leg);
  return all;
}

std::optional<BoundaryPlusStage> solving_stage(const std::vector<PlanResult>& legs) {
  std::optional<BoundaryPlusStage> last;
  for (const PlanResult& leg : legs) last = std::max(last, leg.solved_by);
  return last;
}

}  // namespace clearway
