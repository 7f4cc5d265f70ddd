#include "planning/boundary/boundary.hpp"

#include "mapping/system/number_text.hpp"
#include "planning/boundary/boundary_controller.hpp"
#include "planning/problem/option_reader.hpp"

namespace clearway {
namespace {

/// The motion of one query.
class BoundaryMotion {
 public:
  BoundaryMotion(const PlanProblem& problem, const BoundaryOptions& given)
      : problem_(problem),
        options_(resolve(given.local, problem)),
        max_steps_(resolve_max_steps(given.local, options_, problem)),
        motion_(problem, options_),
        controller_(problem.space.robot(), given, options_) {}

  PlanResult run(const PlanResult& ends) {
    std::string failure;
    while (failure.empty() && !motion_.is_at_goal()) {
      if (problem_.out_of_time()) return finish(ends, PlanStatus::timed_out, "Out of time.");
      failure = motion_.steps() >= max_steps_ ? stopped("Reached max_steps") : advance();
    }
    const std::string solved =
        "Reached the goal after " + counted(controller_.counts().deadlocks, "deadlock") + ".";
    return finish(ends, failure.empty() ? PlanStatus::solved : PlanStatus::no_path,
                  failure.empty() ? solved : failure);
  }

 private:
  /// One step. Returns why the motion ends, or nothing.
  std::string advance() {
    constraints_ = constraints_at(problem_.space, motion_.position(), options_);
    const Eigen::VectorXd wanted = step_to_goal(options_, motion_.position(), problem_.goal);
    local_ = local_step(constraints_, wanted, options_);
    motion_.note(constraints_, local_);
    const BoundaryChoice choice =
        controller_.next(constraints_, local_, wanted, motion_.position(), problem_.goal);
    if (!choice.why.empty()) return stopped(choice.why);
    const WaypointOrigin origin =
        choice.is_local ? WaypointOrigin{PathPhase::free_motion}
                        : WaypointOrigin{PathPhase::boundary,
                                         followed_name(problem_.space, constraints_, choice.followed)};
    if (motion_.take(choice.step, origin)) return "";
    return stopped(choice.is_local ? "The next local step could not be certified free"
                                   : "The next step along the boundary could not be certified free");
  }

  std::string stopped(const std::string& why) const {
    return why + ", after " + counted(motion_.steps(), "step") + " and " +
           counted(controller_.counts().deadlocks, "deadlock") + ", " +
           short_text(motion_.distance_to_goal()) + " from the goal in joint space: " +
           holding_back(problem_.space, constraints_, local_.multipliers) + ".";
  }

  PlanResult finish(const PlanResult& ends, PlanStatus status, const std::string& explanation) const {
    PlanResult result = motion_.result(ends, status, explanation);
    const BoundaryController::Counts& counts = controller_.counts();
    result.statistics["steps_local"] = counts.local;
    result.statistics["steps_boundary"] = counts.boundary;
    result.statistics["deadlocks"] = counts.deadlocks;
    result.statistics["constraint_switches"] = counts.switches;
    result.statistics["boundaries_lost"] = counts.lost;
    result.statistics["vertices_relaxed"] = counts.relaxed;
    return result;
  }

  const PlanProblem& problem_;
  const DamperOptions options_;
  const int max_steps_;
  CertifiedMotion motion_;
  BoundaryController controller_;
  StepConstraints constraints_;
  LocalStep local_;
};

}  // namespace

BoundaryOptions read_options(OptionReader& reader, BoundaryOptions initial) {
  const std::string side = initial.side == BoundarySide::upper ? "upper" : "lower";
  BoundaryOptions options;
  options.local = read_options(reader, initial.local);
  options.enter_ratio = reader.number("enter_ratio", initial.enter_ratio, 0.0, 0.99);
  options.leave_ratio = reader.number("leave_ratio", initial.leave_ratio, 0.01, 1.0);
  options.side =
      reader.choice("side", side, {"upper", "lower"}) == "upper" ? BoundarySide::upper : BoundarySide::lower;
  return options;
}

Boundary::Boundary(const BoundaryOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult Boundary::plan(const PlanProblem& problem) const {
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  return BoundaryMotion(problem, options_).run(ends);
}

}  // namespace clearway
