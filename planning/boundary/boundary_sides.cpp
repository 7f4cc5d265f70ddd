#include "planning/boundary/boundary_sides.hpp"

#include "planning/problem/option_reader.hpp"

namespace clearway {

BoundarySides::BoundarySides(const BoundaryOptions& options)
    : Planner(table_name, text_of_options(table_name, options)) {
  const bool is_upper = options.side == BoundarySide::upper;
  const BoundarySide other = is_upper ? BoundarySide::lower : BoundarySide::upper;
  std::vector<double> leave_ratios = {options.leave_ratio};
  if (leave_ratios.front() != 1.0) leave_ratios.push_back(1.0);
  for (const double leave : leave_ratios) {
    for (const BoundarySide side : {options.side, other}) {
      BoundaryOptions changed = options;
      changed.leave_ratio = leave;
      changed.side = side;
      tries_.emplace_back(changed);
    }
  }
}

PlanResult BoundarySides::plan(const PlanProblem& problem) const {
  PlanResult first;
  std::uint64_t configurations = 0, edges = 0;
  for (std::size_t i = 0; i < tries_.size(); ++i) {
    PlanResult result = tries_[i].plan(problem);
    configurations += result.configurations_checked;
    edges += result.edges_checked;
    const bool is_last = result.status != PlanStatus::no_path || i + 1 == tries_.size();
    if (i == 0) first = result;
    if (!is_last) continue;
    if (result.status == PlanStatus::no_path) result = first;
    result.configurations_checked = configurations;
    result.edges_checked = edges;
    result.statistics["tries"] = static_cast<double>(i + 1);
    if (i > 0)
      result.explanation += " (Try " + std::to_string(i + 1) + " of " + std::to_string(tries_.size()) + ".)";
    return result;
  }
  return first;
}

}  // namespace clearway
