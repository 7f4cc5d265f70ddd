#pragma once

#include <atomic>
#include <memory>

#include "planning/problem/planner.hpp"

namespace clearway {

/// Thrown out of a plan that is stopped: nobody waits for it any more.
struct PlanStopped {};

/// A planner whose time is over as soon as `is_stopped` is set; else the same as the one that it asks.
class StoppablePlanner final : public Planner {
 public:
  StoppablePlanner(std::shared_ptr<const Planner> planner,
                   std::shared_ptr<const std::atomic<bool>> is_stopped);

  /// @throws PlanStopped when it is stopped
  PlanResult plan(const PlanProblem& problem) const override;
  void prepare(const ConfigurationSpace& space) const override { planner_->prepare(space); }

 private:
  std::shared_ptr<const Planner> planner_;
  std::shared_ptr<const std::atomic<bool>> is_stopped_;
};

}  // namespace clearway
