#include "apps/query/advice.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "planning/planner_table.hpp"

namespace clearway {
namespace {

constexpr double longest_search = 5.0;  ///< seconds: advice is not worth a long wait

}  // namespace

void advise(const Query& query, Plan& plan) {
  if (plan.legs.empty() || plan.status() == PlanStatus::solved) return;
  const std::size_t failed = plan.legs.size() - 1;
  const Configuration start = failed == 0 ? query.start : plan.legs[failed - 1].waypoints.back();
  const auto planner = make_planner(query.planner, query.options);
  const PathCost cost = path_cost(query);
  const auto begin = std::chrono::steady_clock::now();
  const double limit = std::min(longest_search, query.time_limit);
  const bool follows_lattice = query.planner == "beam" || query.planner == "beam_reference";
  PaintAdvice advice;
  try {
    advice = advise_paint(
        *planner,
        {query.space, cost, start, query.goals[failed], query.seed,
         [&] {
           return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > limit;
         }},
        follows_lattice);
  } catch (const std::invalid_argument&) {
    return;  // beam_guided cannot search for this robot: no advice, and the plan stays as it is
  }
  plan.paint = advice.spheres;
  if (const std::string sentence = advice.sentence(); !sentence.empty()) {
    std::string& explanation = plan.legs[failed].explanation;
    explanation += (explanation.empty() ? "" : " ") + sentence;
  }
}

}  // namespace clearway
