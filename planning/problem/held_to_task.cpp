#include "planning/problem/held_to_task.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

bool is_sound(const std::vector<Configuration>& path, const PlanProblem& problem) {
  return std::all_of(path.begin(), path.end(), [&](const Configuration& q) {
    return q.size() == problem.start.size() && q.allFinite();
  });
}

std::string off_text(double off, const char* verb, const char* from) {
  return std::string("it ") + verb + " " + short_text(off, 3) + " (rad or m) from the " + from;
}

/// Why a path of sound waypoints is none; empty: it is one.
std::string fault_of(const Planner& planner, const PlanProblem& problem, const PlanResult& result) {
  if (result.waypoints.empty()) return "it has no waypoints";
  const Configuration &first = result.waypoints.front(), &last = result.waypoints.back();
  const double begins = (first - problem.start).lpNorm<Eigen::Infinity>();
  if (begins > contract_tolerance) return off_text(begins, "begins", "start");
  const double ends = (last - problem.goal).lpNorm<Eigen::Infinity>();
  if (ends <= contract_tolerance || ends_in_goal_box(planner.name(), result, problem.goal)) return "";
  return off_text(ends, "ends", "goal");
}

void replace_figures(const PlanProblem& problem, PlanResult& result) {
  if (!std::isfinite(result.cost) || !std::isfinite(result.last_segment_cost)) {
    result.cost = result.waypoints.size() > 1 ? problem.cost(result.waypoints) : 0.0;
    result.last_segment_cost = 0.0;
  }
  if (!std::isfinite(result.final_distance)) result.final_distance = 0.0;
  if (result.process_time &&
      !(std::isfinite(result.process_time->wall) && std::isfinite(result.process_time->cpu)))
    result.process_time.reset();
}

}  // namespace

bool ends_in_goal_box(std::string_view planner, const PlanResult& leg, const Configuration& goal) {
  const bool is_beam = planner == "beam" || planner == "beam_reference";
  return is_beam && !leg.last_segment &&
         (leg.waypoints.back() - goal).norm() <= leg.final_distance + contract_tolerance;
}

PlanResult held_to_task(const Planner& planner, const PlanProblem& problem) {
  PlanResult result = planner.plan(problem);
  const bool sound = is_sound(result.waypoints, problem) && is_sound(result.explored, problem);
  if (!sound) result.waypoints.clear(), result.explored.clear(), result.origins.clear();
  if (result.status != PlanStatus::solved) {
    result.waypoints.clear();
    replace_figures(problem, result);
    return result;
  }
  const std::string fault =
      sound ? fault_of(planner, problem, result)
            : "a waypoint is not " + std::to_string(problem.start.size()) + " finite values";
  if (!fault.empty()) {
    result.status = PlanStatus::no_path;
    result.explanation = "Planner " + quote(planner.name()) + " gave a path that is none: " + fault + ".";
    if (result.explored.empty()) result.explored = std::move(result.waypoints);
    result.waypoints.clear();
    result.origins.clear();
  }
  replace_figures(problem, result);
  return result;
}

}  // namespace clearway
