#include "planning/plan_and_check.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/advice/paint_advice.hpp"
#include "planning/advice/without_map.hpp"
#include "planning/auto_planner.hpp"
#include "planning/check/check_legs.hpp"
#include "planning/problem/held_to_task.hpp"
#include "planning/robot/inverse_dynamics.hpp"
#include "planning/robot/joint_names.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

using Clock = std::chrono::steady_clock;

// What plan files may say, too (files/plan_file_load.cpp).
constexpr double most_payload = 1e6;  ///< kg
constexpr double most_gravity = 1e3;  ///< m/s^2

[[noreturn]] void refuse_field(const std::string& what, const std::string& expected) {
  throw std::invalid_argument("plan query: " + what + ": expected " + expected);
}

void require_values(const Configuration& q, const std::string& field, const Robot& robot) {
  if (q.size() == static_cast<Eigen::Index>(robot.dof())) return;
  refuse_field(field + " has " + counted(q.size(), "value"),
               std::to_string(robot.dof()) + ", one for each joint of robot " + quote(robot.name));
}

void require_fields(const PlanQuery& query) {
  const Robot& robot = query.space.robot();
  require_values(query.start, "start", robot);
  for (std::size_t i = 0; i < query.goals.size(); ++i) {
    require_values(query.goals[i], "goal " + std::to_string(i + 1), robot);
  }
  if (!(query.time_limit > 0.0))
    refuse_field("time_limit is " + short_text(query.time_limit) + " s", "a number above 0");
  if (!(query.advice_time >= 0.0))
    refuse_field("advice_time is " + short_text(query.advice_time) + " s", "a number from 0");
  if (!(query.payload >= 0.0 && query.payload <= most_payload))
    refuse_field("payload is " + short_text(query.payload) + " kg", "a number from 0 to 1000000");
  if (!(query.gravity.norm() <= most_gravity)) {
    const std::vector<double> values(query.gravity.begin(), query.gravity.end());
    refuse_field("gravity is " + to_text(values) + " m/s^2", "finite numbers, at most 1000 m/s^2 together");
  }
  Robot loaded = robot;
  for (const LegLoad& load : query.loads) {
    loaded = with_load(loaded, load.load);
    for (const int leg : load.legs)
      if (leg < 0 || leg >= static_cast<int>(query.goals.size()))
        refuse_field("load " + quote(load.load.name) + " is on leg " + std::to_string(leg + 1),
                     "legs from 1 to " + std::to_string(query.goals.size()) + ", one for each goal");
  }
  for (const auto& [name, policy] : query.load_policies)
    if (std::none_of(loaded.loads.begin(), loaded.loads.end(),
                     [&](const Load& load) { return load.name == name; }))
      refuse_field("load_policies names " + quote(name), "a load of the query");
  if (query.survey) require_parts(query.survey->allow_outside, loaded, "plan query: survey.allow_outside");
}

/// The space of each leg: of the robot with the loads that ride on it. Legs with the same loads share one.
class LegSpaces {
 public:
  explicit LegSpaces(const PlanQuery& query) : query_(query) {
    std::map<std::vector<std::string>, const ConfigurationSpace*> known = {{{}, &query.space}};
    for (std::size_t leg = 0; leg < query.goals.size(); ++leg) {
      Robot robot = robot_of_leg(query.space.robot(), query.loads, static_cast<int>(leg));
      std::vector<std::string> names;
      for (const Load& load : robot.loads) names.push_back(load.name);
      const ConfigurationSpace*& space = known[names];
      if (!space) {
        owned_.push_back(loaded_space(query, std::move(robot)));
        space = owned_.back().get();
      }
      of_leg_.push_back(space);
    }
  }

  /// The joints that hold a load stand as they do where the leg starts.
  const ConfigurationSpace& of(std::size_t leg, const Configuration& from) const {
    const ConfigurationSpace& space = *of_leg_[leg];
    const bool is_held =
        std::any_of(space.robot().loads.begin(), space.robot().loads.end(),
                    [&](const Load& load) { return !grip_joints(space.robot(), load).empty(); });
    if (!is_held) return space;
    for (const Gripped& known : gripped_)
      if (known.loose == &space && grip_violation(space.robot(), known.from, from).empty())
        return *known.space;
    gripped_.push_back({&space, from, loaded_space(query_, with_still_grip(space.robot(), from))});
    return *gripped_.back().space;
  }

  /// Of every part, loads included.
  std::map<std::string, Policy> policies() const {
    std::map<std::string, Policy> policies;
    for (const ConfigurationSpace* space : of_leg_)
      policies.insert(space->policies().begin(), space->policies().end());
    return policies;
  }

 private:
  static std::unique_ptr<ConfigurationSpace> loaded_space(const PlanQuery& query, Robot robot) {
    Policies policies{.parts = query.space.policies(), .other = Policy::not_occupied};
    for (const Load& load : robot.loads) {
      const auto given = query.load_policies.find(load.name);
      if (given != query.load_policies.end()) policies.parts[load.name] = given->second;
    }
    return std::make_unique<ConfigurationSpace>(std::move(robot), query.space.map(), policies,
                                                query.space.options());
  }

  struct Gripped {
    const ConfigurationSpace* loose;
    Configuration from;
    std::unique_ptr<ConfigurationSpace> space;
  };
  const PlanQuery& query_;
  std::vector<std::unique_ptr<ConfigurationSpace>> owned_;
  std::vector<const ConfigurationSpace*> of_leg_;
  mutable std::vector<Gripped> gripped_;
};

/// A robot whose file gives links that move no mass costs nothing, or too little, which is no answer.
std::string cost_caveat(const Robot& robot, const Eigen::Vector3d& gravity) {
  const std::string missing = missing_masses(robot, gravity);
  return missing.empty() ? "" : missing + ", so the cost is not known.";
}

/// Eq. 11 of Chong et al. 2008 counts as reached what lies within one step of every joint: with steps larger
/// than the way nothing has to move.
void report_step_beyond_way(const PlannerOptions& in_force, PlanResult& leg) {
  if (leg.status != PlanStatus::solved || leg.search_steps > 0 || !in_force.contains("step")) return;
  if (leg.final_distance == 0.0) return;  // the start is the goal
  leg.explanation += " The step (option 'step' or 'step_deg') is larger than the way, " +
                     short_text(leg.final_distance, 3) + ": " +
                     (leg.last_segment ? "all of it is the last segment." : "the path ends where it starts.");
}

void plan_legs(const PlanQuery& query, const Planner& planner, const LegSpaces& spaces, Plan& plan) {
  Configuration from = query.start;
  for (const Configuration& goal : query.goals) {
    const ConfigurationSpace& space = spaces.of(plan.legs.size(), from);
    if (const std::string moved = grip_violation(space.robot(), from, goal); !moved.empty()) {
      PlanResult refused;
      refused.status = PlanStatus::goal_invalid;
      refused.explanation = "The goal: " + moved + ".";
      plan.legs.push_back(std::move(refused));
      break;
    }
    Configuration to = goal;  // whose grip may be off by rounding
    for (const Load& load : space.robot().loads)
      for (const int j : grip_joints(space.robot(), load)) to[j] = from[j];
    planner.prepare(space);
    WorkMeter meter;
    const ConfigurationSpace asked = query.splits_cpu ? space.metered(meter) : space;
    const double cpu_before = thread_cpu_seconds();
    const auto begin = Clock::now();
    const PathCost cost = path_cost(query, space.robot());
    const PlanProblem problem{
        asked,           cost, from, to, query.seed, [&] { return seconds_since(begin) > query.time_limit; },
        query.time_limit};
    plan.legs.push_back(held_to_task(planner, problem));
    const ProcessTime own{seconds_since(begin), thread_cpu_seconds() - cpu_before};
    const ProcessTime took = plan.legs.back().process_time.value_or(own);
    if (query.splits_cpu && !plan.legs.back().process_time) plan.legs.back().work = meter.times(own.cpu);
    plan.time_s += took.wall;
    plan.cpu_s += took.cpu;
    report_step_beyond_way(plan.options, plan.legs.back());
    if (plan.legs.back().status != PlanStatus::solved) break;
    from = plan.legs.back().waypoints.back();
  }
}

void check_whole_path(const ConfigurationSpace& space, Plan& plan) {
  if (plan.waypoints().empty()) return;
  const auto begin = Clock::now();
  const ThreadStopwatch cpu(plan.check_cpu_s);
  plan.validation = check_legs(legs_of(plan, space.robot(), space.map()), plan.policies, plan.padding, 0.0,
                               plan.seen_within);
  plan.check_s = seconds_since(begin);
}

/// Adds what the map knows of where the robot goes, and refuses for it.
void survey(const SurveyDemands& demands, const ConfigurationSpace& space, Plan& plan) {
  plan.survey = survey_legs(legs_of(plan, space.robot(), space.map()), plan.policies);
  plan.allow_outside = demands.allow_outside;
  refuse_surveyed(*plan.survey, demands, plan.validation);
}

void explain(PlanResult& leg, const std::string& sentence) {
  if (!sentence.empty()) leg.explanation += (leg.explanation.empty() ? "" : " ") + sentence;
}

/// Where painting more would connect the ends of the leg that was not solved: the spheres go to `plan.paint`,
/// the sentence to the leg's explanation. Nothing that is painted helps where the robot itself is in the way,
/// which is then the sentence.
void advise(const PlanQuery& query, const Planner& planner, const LegSpaces& spaces, Plan& plan) {
  const std::size_t failed = plan.legs.size() - 1;
  const Configuration start = failed == 0 ? query.start : plan.legs[failed - 1].waypoints.back();
  const ConfigurationSpace& space = spaces.of(failed, start);
  if (!grip_violation(space.robot(), start, query.goals[failed]).empty()) return;
  const PathCost cost = path_cost(query, space.robot());
  const bool follows_lattice = planner.name() == "beam" || planner.name() == "beam_reference";
  const auto begin = Clock::now();
  const double limit = std::min(query.advice_time, query.time_limit);
  std::atomic<bool> ran_out{false};  // a planner may ask from several threads
  const PlanProblem problem{space, cost, start, query.goals[failed], query.seed, [&] {
                              if (seconds_since(begin) > limit) ran_out = true;
                              return ran_out.load();
                            }};
  PlanResult& leg = plan.legs[failed];
  const bool has_no_path = leg.status == PlanStatus::no_path || leg.status == PlanStatus::timed_out;
  if (has_no_path && is_without_path_in_empty_map(problem))
    return explain(leg,
                   "In an empty map no path is found either: the robot itself seems to keep start and goal "
                   "apart, by bodies that would touch each other or by limits of joints.");
  PaintAdvice advice;
  try {
    advice = advise_paint(planner, problem, follows_lattice);
  } catch (const std::invalid_argument&) {
    return;  // beam_guided cannot search for this robot: no advice, and the plan stays as it is
  }
  plan.paint = advice.spheres;
  std::string sentence = advice.sentence();
  if (sentence.empty() && ran_out)
    sentence = "Where painting would help was not found in " + short_text(limit) + " s.";
  explain(leg, sentence);
}

}  // namespace

Plan empty_plan(const PlanQuery& query, const Planner& planner) {
  require_fields(query);
  const Robot& robot = query.space.robot();
  Plan plan;
  plan.robot = query.robot_name.empty() ? robot.name : query.robot_name;
  plan.robot_scale = robot.scale;
  plan.map_from_base = robot.map_from_base;
  plan.joints = joint_names(robot);
  plan.group = robot.group;
  for (const HeldJoint& joint : robot.held) plan.held[joint.name] = joint.value;
  plan.xacro = robot.xacro;
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
  plan.cost_caveat = cost_caveat(robot, query.gravity);
  plan.payload = query.payload;
  plan.gravity = query.gravity;
  plan.query = query.name;
  plan.loads = query.loads;
  plan.start = query.start;
  plan.goals = query.goals;
  return plan;
}

PathCost path_cost(const PlanQuery& query) { return path_cost(query, query.space.robot()); }

PathCost path_cost(const PlanQuery& query, const Robot& robot) {
  return PathCost(robot, {.gravity = robot.map_from_base.linear().transpose() * query.gravity,
                          .payload_mass = query.payload});
}

Plan plan_and_check(const PlanQuery& query) {
  if (query.goals.empty()) refuse_field("goals are none", "at least one");
  require_fields(query);
  const auto planner = query.planner ? query.planner : std::make_shared<const AutoPlanner>();
  const LegSpaces spaces(query);
  Plan plan = empty_plan(query, *planner);
  plan.policies = spaces.policies();
  plan_legs(query, *planner, spaces, plan);
  check_whole_path(query.space, plan);
  if (query.survey) survey(*query.survey, query.space, plan);
  if (plan.status() != PlanStatus::solved && query.advice_time > 0.0) advise(query, *planner, spaces, plan);
  return plan;
}

}  // namespace clearway
