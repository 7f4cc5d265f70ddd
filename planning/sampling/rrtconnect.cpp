#include "planning/sampling/rrtconnect.hpp"

#include "planning/problem/option_reader.hpp"
#include "planning/routes/route_guide.hpp"
#include "planning/sampling/sampled_trees.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

/// Samples along a route for the hand, where there is one.
TreeGuide find_guide(const PlanProblem& problem, double share) {
  const EndEffector hand = find_end_effector(problem.space);
  return guide_along(problem, hand, find_end_effector_route(problem, hand), share);
}

}  // namespace

RrtConnectOptions read_options(OptionReader& reader, RrtConnectOptions initial) {
  return {.range = reader.number_or_auto("range", initial.range, 0.0, 1e3),
          .prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6),
          .max_samples = reader.integer("max_samples", initial.max_samples, 1, 100000000),
          .guided_share = reader.number("guided_share", initial.guided_share, 0.0, 1.0),
          .shortcuts = reader.integer("shortcuts", initial.shortcuts, 0, 1000000)};
}

RrtConnect::RrtConnect(const RrtConnectOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult RrtConnect::plan(const PlanProblem& problem) const {
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  const Eigen::VectorXd weight = joint_weights(problem.space, options_.prismatic_scale);
  TreeOptions trees{.weight = weight, .range = options_.range, .max_samples = options_.max_samples};
  trees.unguided_samples = unguided_samples;
  if (options_.guided_share > 0.0)
    trees.find_guide = [&] { return find_guide(problem, options_.guided_share); };
  return result_of(problem, ends, connect_trees(problem, trees), weight, options_.shortcuts);
}

}  // namespace clearway
