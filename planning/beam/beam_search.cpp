#include "planning/beam/beam_search.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/system/number_text.hpp"
#include "planning/beam/neighbour_queue.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/routes/painted_parts.hpp"

namespace clearway {
namespace {

/// Why the best node could not be left towards the goal: its nearer neighbours, best first.
std::string blocking_sentence(const PlanProblem& problem, const Lattice& lattice, const BeamPaths& paths) {
  const Head& best = paths.head(paths.best_head());
  NeighbourQueue queue(lattice);
  queue.add_head(0, best.node);
  int nearer = 0, blocked = 0;
  std::string first;
  while (!queue.empty() && nearer < 27 && queue.next_squared_distance() < best.squared_distance) {
    ++nearer;
    const LatticeIndex node = queue.pop().node;
    const Configuration from = lattice.configuration(best.node), to = lattice.configuration(node);
    const Verdict verdict = problem.space.check(to);
    const bool is_blocked = !verdict.is_free() || !problem.space.is_edge_free(from, to);
    if (!is_blocked) continue;
    ++blocked;
    if (first.empty()) first = verdict.is_free() ? "the way to it is not certified free" : verdict.sentence();
  }
  if (blocked == 0) return "Its nearer neighbours are free but had been searched before.";
  return std::to_string(blocked) + " of its " + std::to_string(nearer) +
         " best neighbours are blocked; at the best of them, " + first + ".";
}

/// The optional last edge from the goal box of Chong 2008, eq. 11 to the exact goal.
void append_last_segment(const PlanProblem& problem, PlanResult& result) {
  const Configuration end = result.waypoints.back();
  if (end == problem.goal) return;
  ++result.edges_checked;
  if (!problem.space.is_edge_free(end, problem.goal)) {
    result.explanation += " The last segment to the exact goal is not free: the path ends " +
                          short_text(result.final_distance) + " before it.";
    return;
  }
  result.last_segment = true;
  result.last_segment_cost = problem.cost({end, problem.goal});
  result.waypoints.push_back(problem.goal);
}

/// Each step of the search is one of the path.
std::vector<WaypointOrigin> lattice_origins(std::size_t waypoints, bool last_segment) {
  std::vector<WaypointOrigin> origins(waypoints);
  for (std::size_t i = 1; i < waypoints; ++i) origins[i] = {PathPhase::lattice, {}, static_cast<int>(i)};
  if (last_segment) origins.back() = {PathPhase::last_segment};
  return origins;
}

void report_success(const PlanProblem& problem, const BeamOptions& options, const BeamPaths& paths,
                    PlanResult& result) {
  result.status = PlanStatus::solved;
  result.waypoints = paths.path_to(paths.goal_head());
  result.cost = paths.head(paths.goal_head()).cost;
  result.search_steps = static_cast<int>(result.waypoints.size()) - 1;
  result.final_distance = (result.waypoints.back() - problem.goal).norm();
  result.explanation = "Reached the goal box in " + counted(result.search_steps, "step") + ".";
  if (options.last_segment) append_last_segment(problem, result);
  result.origins = lattice_origins(result.waypoints.size(), result.last_segment);
}

void report_failure(const PlanProblem& problem, const Lattice& lattice, const BeamPaths& paths,
                    bool out_of_time, PlanResult& result) {
  const Head& best = paths.head(paths.best_head());
  result.status = out_of_time ? PlanStatus::timed_out : PlanStatus::no_path;
  result.explored = paths.path_to(paths.best_head());
  result.origins = lattice_origins(result.explored.size(), false);
  result.search_steps = paths.steps();
  result.final_distance = (lattice.configuration(best.node) - problem.goal).norm();
  const char* how = out_of_time ? "out of time" : paths.beam().empty() ? "stalled" : "stalled (max_steps)";
  result.explanation = std::string(how) + " after " + counted(paths.steps(), "step") + ": the best node is " +
                       short_text(result.final_distance) + " from the goal in joint space. ";
  if (out_of_time) {  // looking closer takes time, too
    result.explanation.pop_back();
    return;
  }
  std::string parted = parted_volume_sentence(problem);
  if (parted.empty()) {
    result.explanation += blocking_sentence(problem, lattice, paths);
  } else {
    parted.front() = 'T';
    result.explanation += parted + ".";
  }
}

}  // namespace

BeamPaths::BeamPaths(const PlanProblem& problem, const Lattice& lattice)
    : problem_(problem), lattice_(lattice), visited_(static_cast<std::size_t>(lattice.dof())) {
  Head start;
  start.node.assign(static_cast<std::size_t>(lattice.dof()), 0);
  start.squared_distance = lattice.squared_distance(start.node);
  start.forces = problem.cost.generalized_forces(problem.start);
  admit(std::move(start));
}

Head BeamPaths::extend(int parent, const LatticeIndex& node, const Eigen::VectorXd& forces) const {
  Head to;
  to.node = node;
  to.squared_distance = lattice_.squared_distance(node);
  to.cost =
      cost_through(parent, lattice_.configuration(head(parent).node), lattice_.configuration(node), forces);
  to.parent = parent;
  to.forces = forces;
  return to;
}

double BeamPaths::cost_through(int parent, const Configuration& from, const Configuration& to,
                               const Eigen::VectorXd& forces) const {
  const Head& before = head(parent);
  step_ = to - from;
  return before.cost + problem_.cost.step_cost(before.forces, forces, step_);
}

void BeamPaths::admit(Head head) {
  const int number = head_count();
  visited_.insert(head.node);
  if (number == 0 || head.squared_distance < this->head(best_head_).squared_distance) best_head_ = number;
  if (!lattice_.reaches_goal(head.node)) {
    beam_.push_back(number);
  } else if (goal_head_ < 0 || head.cost < this->head(goal_head_).cost) {
    goal_head_ = number;
    if (first_goal_step_ < 0) first_goal_step_ = steps_;
  }
  heads_.push_back(std::move(head));
}

void BeamPaths::select(std::vector<Head> kept) {
  ++steps_;
  beam_.clear();
  for (Head& head : kept) admit(std::move(head));
  if (goal_head_ < 0) return;
  const double saved = head(goal_head_).cost;
  std::erase_if(beam_, [&](int i) { return head(i).cost >= saved; });
}

std::vector<Configuration> BeamPaths::path_to(int head_number) const {
  std::vector<Configuration> path;
  for (int i = head_number; i >= 0; i = head(i).parent) path.push_back(lattice_.configuration(head(i).node));
  std::reverse(path.begin(), path.end());
  return path;
}

PlanResult search_beam(const PlanProblem& problem, const BeamOptions& options, const NextHeads& next_heads) {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  const Lattice lattice(problem, options);
  const double automatic = std::min(20.0 * lattice.longest_ramp() + 200.0, 1e8);
  const int max_steps = options.max_steps > 0 ? options.max_steps : static_cast<int>(automatic);
  BeamPaths paths(problem, lattice);
  BeamChecks checks;
  bool out_of_time = false;
  while (!paths.beam().empty() && paths.steps() < max_steps && !out_of_time) {
    std::vector<Head> kept = next_heads(problem, lattice, options, paths, checks);
    out_of_time = problem.out_of_time();
    if (!out_of_time) paths.select(std::move(kept));  // else the step may not be whole
  }
  result.configurations_checked += checks.configurations;
  result.edges_checked += checks.edges;
  if (paths.goal_head() >= 0) {
    report_success(problem, options, paths, result);
    if (out_of_time) result.explanation += " The deadline ended the search for a cheaper path.";
  } else {
    report_failure(problem, lattice, paths, out_of_time, result);
  }
  result.statistics = {{"steps_searched", paths.steps()},
                       {"first_goal_step", paths.first_goal_step()},
                       {"heads", paths.head_count()},
                       {"neighbours_generated", static_cast<double>(checks.neighbours)},
                       {"deadline_hit", out_of_time ? 1.0 : 0.0}};
  return result;
}

}  // namespace clearway
