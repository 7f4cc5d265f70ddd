#include "planning/plan_and_check.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/advice/paint_advice.hpp"
#include "planning/auto_planner.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

[[noreturn]] void refuse_field(const std::string& what, const std::string& expected) {
  throw std::invalid_argument("plan query: " + what + ": expected " + expected);
}

void require_values(const Configuration& q, const std::string& field, const Robot& robot) {
  if (q.size() == static_cast<Eigen::Index>(robot.dof())) return;
  refuse_field(field + " has " + std::to_string(q.size()) + " values",
               std::to_string(robot.dof()) + ", one for each joint of robot '" + robot.name + "'");
}

void require_fields(const PlanQuery& query) {
  const Robot& robot = query.space.robot();
  require_values(query.start, "start", robot);
  if (query.goals.empty()) refuse_field("goals are none", "at least one");
  for (std::size_t i = 0; i < query.goals.size(); ++i) {
    require_values(query.goals[i], "goal " + std::to_string(i + 1), robot);
  }
  if (!(query.time_limit > 0.0))
    refuse_field("time_limit is " + short_text(query.time_limit) + " s", "a number above 0");
  if (!(query.advice_time >= 0.0))
    refuse_field("advice_time is " + short_text(query.advice_time) + " s", "a number from 0");
  if (!(query.payload >= 0.0) || !std::isfinite(query.payload))
    refuse_field("payload is " + short_text(query.payload) + " kg", "a finite number from 0");
  if (!query.gravity.allFinite()) {
    const std::vector<double> values(query.gravity.begin(), query.gravity.end());
    refuse_field("gravity is " + to_text(values) + " m/s^2", "finite numbers");
  }
  if (query.survey) require_parts(query.survey->allow_outside, robot, "plan query: survey.allow_outside");
}

/// A robot whose file gives no link that moves a mass costs nothing, which is no answer.
std::string cost_caveat(const Robot& robot, double payload) {
  bool has_mass = payload > 0.0;
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    has_mass = has_mass || (robot.links[i].mass > 0.0 && is_moved(robot, static_cast<int>(i)));
  return has_mass ? ""
                  : "The robot's file gives the links that move no masses (<inertial>), so the cost is not "
                    "known.";
}

Plan empty_plan(const PlanQuery& query, const Planner& planner) {
  const Robot& robot = query.space.robot();
  Plan plan;
  plan.robot = query.robot_name.empty() ? robot.name : query.robot_name;
  plan.robot_scale = robot.scale;
  plan.map_from_base = robot.map_from_base;
  for (const Joint& joint : robot.joints) plan.joints.push_back(joint.name);
  plan.group = robot.group;
  for (const HeldJoint& joint : robot.held) plan.held[joint.name] = joint.value;
  plan.planner = planner.name();
  plan.options = planner.options();
  plan.seed = query.seed;
  plan.map_file = query.map_file.string();
  plan.map_sha256 = query.map_digest;
  plan.map_resolution = query.space.map().resolution();
  plan.map_integration = to_string(integration_of(query.space.map()));
  plan.map_caveat = map_caveat(query.space.map());
  plan.policies = query.space.policies();
  plan.padding = query.space.options().padding;
  plan.seen_within = query.space.options().seen_within;
  plan.position_accuracy = robot.position_accuracy;
  plan.cost_caveat = cost_caveat(robot, query.payload);
  plan.payload = query.payload;
  plan.gravity = query.gravity;
  plan.query = query.name;
  plan.start = query.start;
  plan.goals = query.goals;
  return plan;
}

/// Eq. 11 of Chong et al. 2008 counts as reached what lies within one step of every joint: with steps larger
/// than the way nothing has to move.
void tell_step_beyond_way(const PlannerOptions& in_force, PlanResult& leg) {
  if (leg.status != PlanStatus::solved || leg.search_steps > 0 || !in_force.contains("step")) return;
  if (leg.final_distance == 0.0) return;  // the start is the goal
  leg.explanation += " The step (option 'step' or 'step_deg') is larger than the way, " +
                     short_text(leg.final_distance, 3) + ": " +
                     (leg.last_segment ? "all of it is the last segment." : "the path ends where it starts.");
}

void plan_legs(const PlanQuery& query, const Planner& planner, const PathCost& cost, Plan& plan) {
  const auto begin = Clock::now();
  const ThreadStopwatch cpu(plan.cpu_s);
  Configuration from = query.start;
  for (const Configuration& goal : query.goals) {
    const auto leg_begin = Clock::now();
    plan.legs.push_back(planner.plan({query.space, cost, from, goal, query.seed,
                                      [&] { return seconds_since(leg_begin) > query.time_limit; }}));
    tell_step_beyond_way(plan.options, plan.legs.back());
    if (plan.legs.back().status != PlanStatus::solved) break;
    from = plan.legs.back().waypoints.back();
  }
  plan.time_s = seconds_since(begin);
}

void check_whole_path(const ConfigurationSpace& space, Plan& plan) {
  const std::vector<Configuration> path = plan.waypoints();
  if (path.empty()) return;
  const auto begin = Clock::now();
  const ThreadStopwatch cpu(plan.check_cpu_s);
  plan.validation =
      check_path(space.robot(), space.map(), plan.policies, plan.padding, path, 0.0, plan.seen_within);
  plan.check_s = seconds_since(begin);
}

/// Adds what the map knows of where the robot goes, and refuses for it.
void survey(const SurveyDemands& demands, const ConfigurationSpace& space, Plan& plan) {
  plan.survey = survey_path(space.robot(), space.map(), plan.policies, plan.waypoints());
  plan.allow_outside = demands.allow_outside;
  refuse_surveyed(*plan.survey, demands, plan.validation);
}

/// Where painting more would connect the ends of the leg that was not solved: the spheres go to `plan.paint`,
/// the sentence to the leg's explanation.
void advise(const PlanQuery& query, const Planner& planner, const PathCost& cost, Plan& plan) {
  const std::size_t failed = plan.legs.size() - 1;
  const Configuration start = failed == 0 ? query.start : plan.legs[failed - 1].waypoints.back();
  const bool follows_lattice = planner.name() == "beam" || planner.name() == "beam_reference";
  const auto begin = Clock::now();
  const double limit = std::min(query.advice_time, query.time_limit);
  PaintAdvice advice;
  try {
    advice = advise_paint(planner,
                          {query.space, cost, start, query.goals[failed], query.seed,
                           [&] { return seconds_since(begin) > limit; }},
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

}  // namespace

PathCost path_cost(const PlanQuery& query) {
  const Robot& robot = query.space.robot();
  return PathCost(robot, {.gravity = robot.map_from_base.linear().transpose() * query.gravity,
                          .payload_mass = query.payload});
}

Plan plan_and_check(const PlanQuery& query) {
  require_fields(query);
  const PathCost cost = path_cost(query);
  const auto planner = query.planner ? query.planner : std::make_shared<const AutoPlanner>();
  Plan plan = empty_plan(query, *planner);
  plan_legs(query, *planner, cost, plan);
  check_whole_path(query.space, plan);
  if (query.survey) survey(*query.survey, query.space, plan);
  if (plan.status() != PlanStatus::solved && query.advice_time > 0.0) advise(query, *planner, cost, plan);
  return plan;
}

}  // namespace clearway
