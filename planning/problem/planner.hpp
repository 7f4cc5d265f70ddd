#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "planning/problem/boundary_plus_stage.hpp"
#include "planning/problem/path_cost.hpp"
#include "planning/problem/waypoint_origin.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

enum class PlanStatus { solved, start_invalid, goal_invalid, no_path, timed_out };
std::string_view to_string(PlanStatus status);

/// One query. The planner keeps nothing between calls; the deadline and the seed are passed in.
struct PlanProblem {
  const ConfigurationSpace& space;
  const PathCost& cost;
  Configuration start;
  Configuration goal;
  std::uint64_t seed = 1;
  std::function<bool()> out_of_time = [] { return false; };
  /// What out_of_time() goes by, s from the call on, for who passes it to another process.
  double time_limit = std::numeric_limits<double>::infinity();
};

/// Start, goals and base count as kept within this, in radians and metres; scales within this share.
constexpr double contract_tolerance = 1e-6;

/// What a process of a planner's own took for a query, s.
struct ProcessTime {
  double wall = 0.0, cpu = 0.0;
};

/// The answer to one query.
struct PlanResult {
  PlanStatus status = PlanStatus::no_path;
  std::string explanation;               ///< one or two sentences: where it stopped and why
  std::vector<Configuration> waypoints;  ///< start first; empty unless solved
  std::vector<Configuration>
      explored;  ///< unless solved: the path to the best node or the trace of the motion
  /// Of each waypoint, unless solved of each of `explored`: how the planner got there. Empty: not known.
  std::vector<WaypointOrigin> origins;
  double cost = 0.0;               ///< joules, Chong 2008, eq. 9, of the waypoints without the last segment
  double last_segment_cost = 0.0;  ///< joules of the segment to the exact goal, when appended
  bool last_segment = false;  ///< the last edge goes from the lattice (Chong 2008, eq. 11) to the exact goal
  double final_distance = 0.0;  ///< ||q_end - goal|| before the last segment
  int search_steps = 0;         ///< edges, the last segment not counted
  std::uint64_t configurations_checked = 0;
  std::uint64_t edges_checked = 0;
  /// Counts in place of what this process took, which only reads and costs the answer.
  std::optional<ProcessTime> process_time;
  WorkTimes work;  ///< how its CPU time split; nothing unless PlanQuery::splits_cpu, or of another process
  std::map<std::string, double> statistics;    ///< planner's own figures, by name
  std::optional<BoundaryPlusStage> solved_by;  ///< none of another planner, and unless solved
};

/// Options in their text form, by name: as --set gives them, --print-options prints them and plan.json stores
/// them.
using PlannerOptions = std::map<std::string, std::string>;

/// A planner: a question answered. Thread safe. Each is made of a struct of options, which checks their
/// ranges: Beam({.width = 20}); or by its name and their text form, see planner_table.hpp.
class Planner {
 public:
  virtual ~Planner() = default;
  virtual PlanResult plan(const PlanProblem& problem) const = 0;
  /// Makes ready for queries in this space, where that is no part of their time: another process starts.
  virtual void prepare(const ConfigurationSpace& /*space*/) const {}
  const std::string& name() const { return name_; }            ///< in the planner table: "beam"
  const PlannerOptions& options() const { return in_force_; }  ///< all of them, as in force

 protected:
  Planner(std::string_view name, PlannerOptions in_force) : name_(name), in_force_(std::move(in_force)) {}

 private:
  std::string name_;
  PlannerOptions in_force_;
};

/// Checks start and goal as every planner must: status solved when both are fine, else start_invalid or
/// goal_invalid with the sentence. Called by planners first.
PlanResult check_ends(const PlanProblem& problem);

}  // namespace clearway
