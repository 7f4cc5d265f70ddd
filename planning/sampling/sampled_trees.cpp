#include "planning/sampling/sampled_trees.hpp"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include "planning/path/any_angle.hpp"
#include "planning/path/path_pieces.hpp"
#include "planning/path/shortcut.hpp"
#include "planning/sampling/ompl_query.hpp"

namespace clearway {

TreePath connect_trees(const PlanProblem& problem, const TreeOptions& options) {
  OmplQuery query{problem, options.weight, std::mt19937_64(problem.seed), options.guide};
  const auto information = certified_space(query);
  const auto definition = problem_definition(query, information);
  ompl::geometric::RRTConnect planner(information);
  planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();  // the default draws from OMPL's own generator
  planner.setRange(options.range);
  planner.setProblemDefinition(definition);
  planner.setup();
  TreePath result;
  planner.solve(ompl::base::PlannerTerminationCondition([&] {
    result.out_of_time = problem.out_of_time();
    return result.out_of_time || query.samples >= options.max_samples;
  }));
  result.waypoints = waypoints(query, *definition);
  result.samples = query.samples;
  result.configurations = query.configurations;
  result.edges = query.edges;
  return result;
}

PlanResult result_of(const PlanProblem& problem, const PlanResult& ends, TreePath found,
                     const Eigen::VectorXd& weight, int shortcuts) {
  PlanResult result = ends;
  std::vector<Configuration> path = std::move(found.waypoints);
  if (path.size() > 2) path = shortcut(problem.space, std::move(path), weight, problem.seed, shortcuts);
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
