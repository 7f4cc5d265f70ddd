#include "planning/sampling/rrtconnect.hpp"

#include "planning/problem/option_reader.hpp"
#include "planning/sampling/sampled_trees.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {

RrtConnectOptions read_options(OptionReader& reader, RrtConnectOptions initial) {
  return {.range = reader.number_or_auto("range", initial.range, 0.0, 1e3),
          .prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6),
          .max_samples = reader.integer("max_samples", initial.max_samples, 1, 100000000),
          .shortcuts = reader.integer("shortcuts", initial.shortcuts, 0, 1000000)};
}

RrtConnect::RrtConnect(const RrtConnectOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult RrtConnect::plan(const PlanProblem& problem) const {
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  const Eigen::VectorXd weight = joint_weights(problem.space, options_.prismatic_scale);
  return result_of(
      problem, ends,
      connect_trees(problem,
                    {.weight = weight, .range = options_.range, .max_samples = options_.max_samples}),
      weight, options_.shortcuts);
}

}  // namespace clearway
