#include "planning/problem/planner.hpp"

#include <algorithm>
#include <numbers>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

constexpr double most_turns = 100.0;  ///< from start to goal, of a joint without limits

/// A joint's value with the unit of its kind: "2.793 rad (160 degrees)", "0.5 m".
std::string with_unit(const Joint& joint, double value) {
  if (joint.kind == JointKind::prismatic) return short_text(value) + " m";
  return short_text(value) + " rad (" + short_text(value * 180.0 / std::numbers::pi) + " degrees)";
}

/// "joint joint1 is at 6.981 rad (400 degrees), 4.189 rad (240 degrees) above its upper limit, 2.793 rad ..."
std::string limit_sentence(const Robot& robot, const std::string& name, const Configuration& q) {
  const auto found = std::find_if(robot.joints.begin(), robot.joints.end(),
                                  [&](const Joint& joint) { return joint.name == name; });
  const Joint& joint = *found;
  const double value = q[found - robot.joints.begin()];
  const bool is_above = value > joint.upper;
  const double limit = is_above ? joint.upper : joint.lower;
  return "joint " + name + " is at " + with_unit(joint, value) + ", " +
         with_unit(joint, is_above ? value - limit : limit - value) +
         (is_above ? " above its upper limit, " : " below its lower limit, ") + with_unit(joint, limit) +
         whose_limit(robot, static_cast<std::size_t>(found - robot.joints.begin()), is_above);
}

/// Why the joints without limits are too far apart to be proved between; empty when they are not.
std::string turns_sentence(const Robot& robot, const Configuration& start, const Configuration& goal) {
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const double from = start[static_cast<Eigen::Index>(j)], to = goal[static_cast<Eigen::Index>(j)];
    if (!is_endless(joint) || std::abs(to - from) <= most_turns * 2.0 * std::numbers::pi) continue;
    return "joint " + shortened(joint.name) + " would make " +
           short_text(std::abs(to - from) / (2.0 * std::numbers::pi), 6) +
           " turns from the start, expected at most " + short_text(most_turns) +
           (repeats_after_turns(robot, j)
                ? "; the same pose is at " +
                      short_text(by_whole_turns(robot, goal, start)[static_cast<Eigen::Index>(j)], 6) + " rad"
                : "");
  }
  return {};
}

/// What is to be said of two parts that touch, of which one has a mesh: a robot whose links are hollow or
/// bent may touch itself by its hulls alone.
std::string hull_clause(const Robot& robot, const Verdict& verdict) {
  if (verdict.obstruction != Obstruction::self_collision) return {};
  const auto hulls_of = [&](const std::string& part) {
    return std::count_if(robot.bodies.begin(), robot.bodies.end(), [&](const Body& body) {
      const bool is_of_link =
          body.part == robot.links[static_cast<std::size_t>(body.link)].name;    // no load's
      return is_of_link && body.part == part && !body.shape.vertices().empty();  // of a convex hull alone
    });
  };
  const auto hulls = std::max(hulls_of(verdict.part), hulls_of(verdict.other));
  if (hulls == 0) return {};
  return hulls == 1 ? ", where a mesh counts as its convex hull (mesh_pieces in its settings splits it)"
                    : ", where a mesh counts as " + std::to_string(hulls) + " convex bodies";
}

/// Why `q` cannot be an end of a path; empty when it can.
std::string refusal(const ConfigurationSpace& space, const Configuration& q) {
  const auto dof = static_cast<Eigen::Index>(space.robot().dof());
  if (q.size() != dof) {
    return "it has " + counted(q.size(), "value") + ", expected " + std::to_string(dof) + " for robot " +
           space.robot().name;
  }
  if (space.is_free(q)) return limit_violation(space.robot(), q);  // several times as fast as the reason
  const Verdict verdict = space.check(q);
  if (verdict.is_free()) return limit_violation(space.robot(), q);  // joints without limits have one, too
  const bool is_past_limit = verdict.obstruction == Obstruction::joint_limit;
  if (is_past_limit) return limit_sentence(space.robot(), verdict.other, q);
  return verdict.sentence() + hull_clause(space.robot(), verdict);
}

}  // namespace

std::string_view to_string(PlanStatus status) {
  switch (status) {
    case PlanStatus::solved:
      return "solved";
    case PlanStatus::start_invalid:
      return "start_invalid";
    case PlanStatus::goal_invalid:
      return "goal_invalid";
    case PlanStatus::no_path:
      return "no_path";
    case PlanStatus::timed_out:
      return "timed_out";
  }
  return "no_path";
}

PlanResult check_ends(const PlanProblem& problem) {
  PlanResult result;
  result.status = PlanStatus::solved;
  result.configurations_checked = 1;
  std::string why = refusal(problem.space, problem.start);
  if (!why.empty()) {
    result.status = PlanStatus::start_invalid;
    if (const std::string empty = empty_volume_sentence(problem.space); !empty.empty()) why = empty;
    result.explanation = "The start is not free: " + why + ".";
    return result;
  }
  ++result.configurations_checked;
  why = refusal(problem.space, problem.goal);
  if (!why.empty()) {
    result.status = PlanStatus::goal_invalid;
    result.explanation = "The goal is not free: " + why + ".";
  } else if (why = turns_sentence(problem.space.robot(), problem.start, problem.goal); !why.empty()) {
    result.status = PlanStatus::goal_invalid;
    result.explanation = "The goal is too far: " + why + ".";
  }
  return result;
}

}  // namespace clearway
