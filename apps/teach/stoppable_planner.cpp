#include "apps/teach/stoppable_planner.hpp"

#include <utility>

namespace clearway {

StoppablePlanner::StoppablePlanner(std::shared_ptr<const Planner> planner,
                                   std::shared_ptr<const std::atomic<bool>> is_stopped)
    : Planner(planner->name(), planner->options()),
      planner_(std::move(planner)),
      is_stopped_(std::move(is_stopped)) {}

PlanResult StoppablePlanner::plan(const PlanProblem& problem) const {
  PlanProblem stoppable = problem;
  stoppable.out_of_time = [this, &problem] { return is_stopped_->load() || problem.out_of_time(); };
  PlanResult result = planner_->plan(stoppable);
  if (is_stopped_->load()) throw PlanStopped();
  return result;
}

}  // namespace clearway
