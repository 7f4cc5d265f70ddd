#include "planning/boundary_plus.hpp"

#include <algorithm>
#include <stdexcept>

#include "planning/any_angle.hpp"
#include "planning/option_reader.hpp"
#include "planning/path_pieces.hpp"
#include "planning/plus_search.hpp"
#include "planning/rounded_corners.hpp"
#include "planning/shortcut.hpp"

namespace clearway {
namespace {

enum class Stage { straight_edge, local_method, planes, hand_over, none };

/// Shortens a path a few attempts at a time, so that the deadline is kept.
std::vector<Configuration> shortened(const PlanProblem& problem, std::vector<Configuration> path,
                                     const Eigen::VectorXd& weight, int attempts) {
  constexpr int at_once = 20;
  for (int done = 0; done < attempts && !problem.out_of_time(); done += at_once) {
    path = shortcut(problem.space, std::move(path), weight, problem.seed + static_cast<std::uint64_t>(done),
                    std::min(at_once, attempts - done));
  }
  return path;
}

Stage solving_stage(const PlanProblem& problem, PlusSearch& search) {
  if (problem.space.is_edge_free(problem.start, problem.goal)) return Stage::straight_edge;
  if (search.by_local_method()) return Stage::local_method;
  if (search.by_planes()) return Stage::planes;
  return search.by_hand_over() ? Stage::hand_over : Stage::none;
}

PlanResult failed(const PlanProblem& problem, const PlusSearch& search, PlanResult result) {
  result.status = problem.out_of_time() ? PlanStatus::timed_out : PlanStatus::no_path;
  result.explored = search.explored();
  result.final_distance = (problem.goal - result.explored.back()).norm();
  result.explanation = "Stuck after " + search.effort() + ".";
  return result;
}

}  // namespace

BoundaryPlus::BoundaryPlus(const PlannerOptions& options) {
  OptionReader reader("boundary_plus", options);
  options_.local = read_constraint_options(reader);
  options_.stride = reader.number("stride", options_.stride, 0.1, 4.0);
  options_.local_steps = reader.integer("local_steps", options_.local_steps, 0, 1000000);
  options_.planes = reader.integer("planes", options_.planes, 0, 1000);
  options_.plane_steps = reader.integer("plane_steps", options_.plane_steps, 1, 1000000);
  options_.max_samples = reader.integer("max_samples", options_.max_samples, 0, 100000000);
  options_.guided_share = reader.number("guided_share", options_.guided_share, 0.0, 1.0);
  options_.shortcuts = reader.integer("shortcuts", options_.shortcuts, 0, 1000000);
  options_.smooth = reader.flag("smooth", options_.smooth);
  reader.refuse_unknown();
  if (options_.local_steps == 0 && options_.planes > 0)
    throw std::invalid_argument(
        "boundary_plus: option 'planes' is " + std::to_string(options_.planes) +
        " and 'local_steps' 0: planes begin at deadlocks of the local method, expected planes 0");
  in_force_ = reader.in_force();
}

PlanResult BoundaryPlus::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  DamperOptions damper = resolve(options_.local, problem);
  if (options_.local.max_step == 0.0) damper.max_step *= options_.stride;
  PlusSearch search(problem, options_, damper);
  const Stage stage = solving_stage(problem, search);
  search.add_statistics(result);
  if (stage == Stage::none) return failed(problem, search, std::move(result));
  result.statistics["solved_by"] = static_cast<double>(stage);
  const std::vector<Configuration> raw = stage == Stage::straight_edge
                                             ? std::vector<Configuration>{problem.start, problem.goal}
                                             : search.trees().path();
  std::vector<Configuration> path = shortened(problem, raw, damper.weight, options_.shortcuts);
  if (options_.smooth) {
    path = rounded_corners(problem, path, damper.weight, {.least_clearance = damper.security_distance},
                           result.edges_checked);
  }
  if (!is_certified(problem.space, path, result.edges_checked)) {
    result.status = problem.out_of_time() ? PlanStatus::timed_out : PlanStatus::no_path;
    result.explanation = "The path found could not be certified free.";
    result.explored = std::move(path);
    return result;
  }
  result.explanation = stage == Stage::straight_edge ? "The straight way is free."
                                                     : "Start and goal were joined by " + search.how() + ".";
  result.statistics["sharpest_turn_rad"] = sharpest_turn(path, damper.weight);
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = sampled_cost(problem.cost, path, damper.weight, AnyAngleOptions().cost_step);
  result.waypoints = std::move(path);
  return result;
}

}  // namespace clearway
