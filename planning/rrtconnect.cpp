#include "planning/rrtconnect.hpp"

#include "planning/any_angle.hpp"
#include "planning/joint_weights.hpp"
#include "planning/option_reader.hpp"
#include "planning/path_pieces.hpp"
#include "planning/sampled_trees.hpp"
#include "planning/shortcut.hpp"

namespace clearway {
RrtConnect::RrtConnect(const PlannerOptions& options) {
  OptionReader reader("rrtconnect", options);
  range_ = reader.number_or_auto("range", 0.0, 1e3);
  prismatic_scale_ = reader.number_or_auto("prismatic_scale", 0.0, 1e6);
  max_samples_ = reader.integer("max_samples", 20000, 1, 100000000);
  shortcuts_ = reader.integer("shortcuts", 100, 0, 1000000);
  reader.refuse_unknown();
  in_force_ = reader.in_force();
}

PlanResult RrtConnect::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  const Eigen::VectorXd weight = joint_weights(problem.space, prismatic_scale_);
  const TreePath found =
      connect_trees(problem, {.weight = weight, .range = range_, .max_samples = max_samples_});
  std::vector<Configuration> path = found.waypoints;
  if (path.size() > 2) path = shortcut(problem.space, std::move(path), weight, problem.seed, shortcuts_);
  result.configurations_checked += found.configurations;
  result.edges_checked = found.edges;
  result.statistics = {{"samples", found.samples}};
  if (path.empty() || !is_certified(problem.space, path, result.edges_checked)) {
    result.status = found.out_of_time ? PlanStatus::timed_out : PlanStatus::no_path;
    result.final_distance = (problem.goal - problem.start).norm();
    result.explanation = path.empty() ? "No path found with " + std::to_string(found.samples) + " samples."
                                      : "The path found could not be certified free.";
    return result;
  }
  result.explanation = "Joined start and goal with " + std::to_string(found.samples) + " samples.";
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = sampled_cost(problem.cost, path, weight, AnyAngleOptions().cost_step);
  result.waypoints = std::move(path);
  return result;
}

}  // namespace clearway
