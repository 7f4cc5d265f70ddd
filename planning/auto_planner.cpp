#include "planning/auto_planner.hpp"

#include <algorithm>
#include <stdexcept>

#include "planning/beam/beam_guided.hpp"
#include "planning/boundary/boundary_plus.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/sampling/rrtconnect.hpp"

namespace clearway {
namespace {

/// Asks one planner after the other.
class Rounds {
 public:
  Rounds(const PlanProblem& problem, const AutoPlannerOptions& options, PlanResult& best)
      : problem_(problem), options_(options), best_(best) {}

  bool trees(int samples) {
    return ask(RrtConnect({.prismatic_scale = options_.prismatic_scale,
                           .max_samples = std::min(samples, options_.max_samples),
                           .shortcuts = options_.shortcuts}));
  }
  bool local_method(int samples) {
    return ask(BoundaryPlus(
        {.max_samples = std::min(samples, options_.max_samples), .shortcuts = options_.shortcuts}));
  }
  bool guided(int samples) {
    try {
      return ask(BeamGuided({.max_samples = std::min(samples, options_.max_samples),
                             .prismatic_scale = options_.prismatic_scale}));
    } catch (const std::invalid_argument&) {
      return false;  // not for this robot
    }
  }

 private:
  /// The result stays the best so far: solved, or the one that came nearest.
  bool ask(const Planner& planner) {
    if (problem_.out_of_time()) return false;
    PlanProblem problem = problem_;
    problem.seed = problem_.seed + asked_++;
    PlanResult result = planner.plan(problem);
    configurations_ += result.configurations_checked;
    edges_ += result.edges_checked;
    const bool is_solved = result.status == PlanStatus::solved;
    if (is_solved || asked_ == 1 || result.final_distance < best_.final_distance) best_ = std::move(result);
    if (!is_solved) best_.status = problem_.out_of_time() ? PlanStatus::timed_out : PlanStatus::no_path;
    if (is_solved) best_.explanation = planner.name() + ": " + best_.explanation;
    best_.configurations_checked = configurations_;
    best_.edges_checked = edges_;
    best_.statistics["rounds"] = static_cast<double>(asked_);
    return is_solved;
  }

  const PlanProblem& problem_;
  const AutoPlannerOptions& options_;
  PlanResult& best_;
  std::uint64_t asked_ = 0, configurations_ = 0, edges_ = 0;
};

}  // namespace

AutoPlannerOptions read_options(OptionReader& reader, AutoPlannerOptions initial) {
  return {.prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6),
          .max_samples = reader.integer("max_samples", initial.max_samples, 1, 100000000),
          .shortcuts = reader.integer("shortcuts", initial.shortcuts, 0, 1000000)};
}

AutoPlanner::AutoPlanner(const AutoPlannerOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult AutoPlanner::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  Rounds rounds(problem, options_, result);
  constexpr int few = 1'000, more = 4'000, many = 20'000;
  if (rounds.trees(few) || rounds.trees(few) || rounds.trees(more)) return result;  // bad luck is often short
  if (rounds.local_method(0) || rounds.guided(more)) return result;
  for (int samples = many; !problem.out_of_time(); samples += std::min(samples, options_.max_samples)) {
    if (rounds.trees(samples) || rounds.local_method(samples) || samples > options_.max_samples) break;
  }
  return result;
}

}  // namespace clearway
