#include "planning/boundary/constraint.hpp"

#include "mapping/system/number_text.hpp"
#include "planning/boundary/certified_motion.hpp"
#include "planning/problem/option_reader.hpp"

namespace clearway {

Constraint::Constraint(const ConstraintOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult Constraint::plan(const PlanProblem& problem) const {
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  const DamperOptions options = resolve(options_, problem);
  const int max_steps = resolve_max_steps(options_, options, problem);
  CertifiedMotion motion(problem, options);
  CreepWatch watch(options.max_step);
  while (!motion.is_at_goal()) {
    if (problem.out_of_time()) return motion.result(ends, PlanStatus::timed_out, "Out of time.");
    const StepConstraints constraints = constraints_at(problem.space, motion.position(), options);
    const Eigen::VectorXd wanted = step_to_goal(options, motion.position(), problem.goal);
    const LocalStep local = local_step(constraints, wanted, options);
    motion.note(constraints, local);
    const auto stop = [&](const std::string& why) {
      return motion.result(ends, PlanStatus::no_path,
                           why + " after " + counted(motion.steps(), "step") + ", " +
                               short_text(motion.distance_to_goal()) + " from the goal in joint space: " +
                               holding_back(problem.space, constraints, local.multipliers) + ".");
    };
    const bool is_creeping = watch.is_creeping(motion.distance_to_goal());
    if (is_creeping || local.step.norm() < deadlock_share * wanted.norm())
      return stop("Deadlock of the local method");
    if (motion.steps() >= max_steps) return stop("Reached max_steps");
    if (!motion.take(local.step)) return stop("The next step could not be certified free");
  }
  return motion.result(ends, PlanStatus::solved, "Reached the goal by local steps alone.");
}

}  // namespace clearway
