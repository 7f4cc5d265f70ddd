#include "planning/advice/without_map.hpp"

#include "mapping/free_space_map.hpp"
#include "planning/sampling/rrtconnect.hpp"

namespace clearway {

bool is_without_path_in_empty_map(const PlanProblem& problem) {
  constexpr int samples = 20000;
  MapOptions map;
  map.resolution = problem.space.map().resolution();
  SpaceOptions options = problem.space.options();
  options.seen_within = 0.0;  // asks for what nothing is in
  const ConfigurationSpace space(problem.space.robot(), FreeSpaceMap(map).snapshot(),
                                 {.other = Policy::not_occupied, .critical_by_default = false}, options);
  const RrtConnect planner({.max_samples = samples, .guided_share = 0.0, .shortcuts = 0});
  const PlanResult result =
      planner.plan({space, problem.cost, problem.start, problem.goal, problem.seed, problem.out_of_time});
  return result.status == PlanStatus::no_path;
}

}  // namespace clearway
