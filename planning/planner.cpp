#include "planning/planner.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "mapping/plain_text.hpp"
#include "planning/beam.hpp"
#include "planning/beam_guided.hpp"
#include "planning/beam_reference.hpp"
#include "planning/boundary.hpp"
#include "planning/boundary_plus.hpp"
#include "planning/boundary_sides.hpp"
#include "planning/constraint.hpp"
#include "planning/nearest_name.hpp"
#include "planning/ompl_planners.hpp"
#include "planning/option_reader.hpp"
#include "planning/painted_parts.hpp"
#include "planning/rrtconnect.hpp"
#include "planning/rrtconnect_fcl.hpp"

namespace clearway {
namespace {

template <typename P>
std::unique_ptr<Planner> make(const PlannerOptions& options) {
  return std::make_unique<P>(options);
}

template <OmplAlgorithm algorithm>
std::unique_ptr<Planner> make_of_ompl(const PlannerOptions& options) {
  return std::make_unique<OmplPlanner>(algorithm, options);
}

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
         (is_above ? " above its upper limit, " : " below its lower limit, ") + with_unit(joint, limit);
}

/// Why `q` cannot be an end of a path; empty when it can.
std::string refusal(const ConfigurationSpace& space, const Configuration& q) {
  const auto dof = static_cast<Eigen::Index>(space.robot().dof());
  if (q.size() != dof) {
    return "it has " + std::to_string(q.size()) + " values, expected " + std::to_string(dof) + " for robot " +
           space.robot().name;
  }
  const Verdict verdict = space.check(q);
  if (verdict.is_free()) return {};
  const bool is_past_limit = verdict.obstruction == Obstruction::joint_limit;
  return is_past_limit ? limit_sentence(space.robot(), verdict.other, q) : verdict.sentence();
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

const std::vector<PlannerEntry>& planner_table() {
  static const std::vector<PlannerEntry> table = {
      {"beam", "beam search on a joint lattice (Chong et al. 2008, Fig. 8)", make<Beam>},
      {"beam_guided", "beam search led by a route through paint or free voxels, then straightened (ours)",
       make<BeamGuided>},
      {"beam_reference", "the same, every neighbour checked: slow and obvious, for comparison",
       make<BeamReference>},
      {"bitstar", "BIT* of OMPL, with certified edges: improves its path until samples or time are out",
       make_of_ompl<OmplAlgorithm::bitstar>},
      {"boundary", "constraint method with boundary following (Lahouar et al. 2006)", make<Boundary>},
      {"boundary_plus",
       "local method and boundary following in several planes, then a hand-over to sampled trees (ours)",
       make<BoundaryPlus>},
      {"boundary_sides", "the same on both sides and with both leave ratios, until one succeeds (ours)",
       make<BoundarySides>},
      {"constraint", "the local step of boundary alone: stops at the first deadlock", make<Constraint>},
      {"est", "EST of OMPL, with certified edges", make_of_ompl<OmplAlgorithm::est>},
      {"prm", "PRM of OMPL, with certified edges", make_of_ompl<OmplAlgorithm::prm>},
      {"rrtconnect", "RRT-Connect of OMPL, with certified edges", make<RrtConnect>},
      {"rrtconnect_fcl", "RRT-Connect of OMPL as most people run it: FCL on an octree, edges not certified",
       make<RrtConnectFcl>},
      {"rrtstar", "RRT* of OMPL, with certified edges: improves its path until samples or time are out",
       make_of_ompl<OmplAlgorithm::rrtstar>},
  };
  return table;
}

std::unique_ptr<Planner> make_planner(std::string_view name, const PlannerOptions& options) {
  std::vector<std::string> known;
  for (const PlannerEntry& entry : planner_table()) {
    if (entry.name == name) return entry.make(options);
    known.emplace_back(entry.name);
  }
  throw std::invalid_argument("unknown planner " + quote(name) + ": did you mean '" +
                              nearest_name(name, known) + "'?");
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
  }
  return result;
}

}  // namespace clearway
