#include "planning/sampling/rrtconnect.hpp"

#include "planning/problem/option_reader.hpp"
#include "planning/sampling/sampled_trees.hpp"
#include "planning/space/joint_weights.hpp"

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
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  const Eigen::VectorXd weight = joint_weights(problem.space, prismatic_scale_);
  return result_of(problem, ends,
                   connect_trees(problem, {.weight = weight, .range = range_, .max_samples = max_samples_}),
                   weight, shortcuts_);
}

}  // namespace clearway
