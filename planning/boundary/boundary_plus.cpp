#include "planning/boundary/boundary_plus.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "planning/boundary/boundary_plus_search.hpp"
#include "planning/path/any_angle.hpp"
#include "planning/path/path_origins.hpp"
#include "planning/path/rounded_corners.hpp"
#include "planning/path/shortcut.hpp"
#include "planning/problem/option_reader.hpp"

namespace clearway {
namespace {

/// As for `constraint`, but the automatic influence is shorter (constraints cost as many voxels as they look
/// at) and the automatic step longer.
DamperOptions damper_of(const BoundaryPlusOptions& options, const PlanProblem& problem) {
  constexpr double influence_share = 0.75;
  ConstraintOptions local = options.local;
  if (local.influence_distance == 0.0)
    local.influence_distance = influence_share * resolve(local, problem).influence_distance;
  DamperOptions damper = resolve(local, problem);
  if (local.max_step == 0.0) damper.max_step *= options.stride;
  return damper;
}

PlanResult failed(const PlanProblem& problem, const BoundaryPlusSearch& search, PlanResult result) {
  result.status = problem.out_of_time() ? PlanStatus::timed_out : PlanStatus::no_path;
  result.explored = search.explored();
  result.final_distance = (problem.goal - result.explored.back()).norm();
  result.explanation = "Stuck after " + search.effort() + ".";
  if (search.trees().samples() > 0) result.explanation += " " + search.trees().reach();
  return result;
}

void refuse_contradictions(const BoundaryPlusOptions& chosen) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("boundary_plus: " + what); };
  if (chosen.local_steps == 0 && chosen.planes > 0) {
    refuse("option 'planes' is " + std::to_string(chosen.planes) +
           " and 'local_steps' 0: planes begin at deadlocks of the local method, expected planes 0");
  }
  if (chosen.local_steps == 0 && chosen.planes == 0 && chosen.max_samples == 0) {
    refuse(
        "options 'local_steps', 'planes' and 'max_samples' are all 0: expected one stage beside the straight "
        "edge");
  }
  if (chosen.local.max_step > 0.0 && chosen.stride != BoundaryPlusOptions().stride) {
    refuse(
        "options 'max_step' and 'stride' are both given: stride multiplies the automatic max_step, expected "
        "one of them");
  }
  if (chosen.local.max_steps != 0) {
    refuse("option 'local.max_steps' is " + std::to_string(chosen.local.max_steps) +
           ": expected 0, since local_steps and plane_steps count");
  }
}

/// The parameters of the local method in force, as `constraint` reports them.
void add_figures(const DamperOptions& damper, PlanResult& result) {
  result.statistics["max_step"] = damper.max_step;
  result.statistics["influence_distance_m"] = damper.influence_distance;
  result.statistics["security_distance_m"] = damper.security_distance;
  result.statistics["xi_m"] = damper.xi;
}

}  // namespace

BoundaryPlusOptions read_options(OptionReader& reader, BoundaryPlusOptions initial) {
  return {.local = read_damper_options(reader, initial.local),
          .stride = reader.number("stride", initial.stride, 0.1, 10.0),
          .local_steps = reader.integer("local_steps", initial.local_steps, 0, 1000000),
          .planes = reader.integer("planes", initial.planes, 0, 1000),
          .plane_steps = reader.integer("plane_steps", initial.plane_steps, 1, 1000000),
          .max_samples = reader.integer("max_samples", initial.max_samples, 0, 100000000),
          .guided_share = reader.number("guided_share", initial.guided_share, 0.0, 1.0),
          .shortcuts = reader.integer("shortcuts", initial.shortcuts, 0, 1000000),
          .smooth = reader.flag("smooth", initial.smooth)};
}

BoundaryPlus::BoundaryPlus(const BoundaryPlusOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {
  refuse_contradictions(options_);
}

PlanResult BoundaryPlus::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  const DamperOptions damper = damper_of(options_, problem);
  BoundaryPlusSearch search(problem, options_, damper);
  const BoundaryPlusStage stage = search.solve();
  search.add_statistics(result);
  add_figures(damper, result);
  if (stage == BoundaryPlusStage::none) return failed(problem, search, std::move(result));
  result.solved_by = stage;
  const std::vector<Configuration> found = search.trees().path();
  std::vector<Configuration> path =
      shortcut(problem.space, found, damper.weight, problem.seed, options_.shortcuts, problem.out_of_time);
  if (options_.smooth) {
    path = rounded_corners(problem, path, damper.weight, {.least_clearance = damper.security_distance},
                           result.edges_checked);
  }
  result.explanation = stage == BoundaryPlusStage::straight_edge
                           ? "The straight way is free."
                           : "Start and goal were joined by " + search.how() + ".";
  result.statistics["deadline_hit"] = problem.out_of_time() ? 1.0 : 0.0;
  result.statistics["sharpest_turn_rad"] = sharpest_turn(path, damper.weight);
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = sampled_cost(problem.cost, path, damper.weight, AnyAngleOptions().cost_step);
  result.origins = origins_after(found, search.trees().path_origins(), path);
  result.waypoints = std::move(path);
  return result;
}

}  // namespace clearway
