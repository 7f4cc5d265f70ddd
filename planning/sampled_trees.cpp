#include "planning/sampled_trees.hpp"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include "planning/ompl_query.hpp"

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

}  // namespace clearway
