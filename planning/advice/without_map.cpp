#include "planning/advice/without_map.hpp"

#include "mapping/free_space_map.hpp"
#include "planning/sampling/rrtconnect.hpp"

namespace clearway {
namespace {

/// Without obstacles, but of the same extent: as far are sliding joints without limits sampled.
Snapshot emptied(const Snapshot& map) {
  MapOptions options;
  options.resolution = map.resolution();
  FreeSpaceMap empty(options);
  if (const Eigen::AlignedBox3d extent = map.bounds(); !extent.isEmpty()) {
    const int volume = empty.add_volume("extent", {});
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * options.resolution);
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(extent.min() + half), Eigen::Vector3d(extent.max() - half)})
      empty.paint(volume, {corner, 0.9 * options.resolution});
  }
  return empty.snapshot();
}

}  // namespace

bool is_without_path_in_empty_map(const PlanProblem& problem) {
  constexpr int samples = 20000;
  SpaceOptions options = problem.space.options();
  options.seen_within = 0.0;  // asks for what nothing is in
  const ConfigurationSpace space(problem.space.robot(), emptied(problem.space.map()),
                                 {.other = Policy::not_occupied, .critical_by_default = false}, options);
  const RrtConnect planner({.max_samples = samples, .guided_share = 0.0, .shortcuts = 0});
  const PlanResult result =
      planner.plan({space, problem.cost, problem.start, problem.goal, problem.seed, problem.out_of_time});
  return result.status == PlanStatus::no_path;
}

}  // namespace clearway
