#include "apps/query/query.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/query/goal_poses.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/survey_figures.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot/held_joints.hpp"
#include "planning/robot_files/xacro_file.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {

RobotRequest robot_request(const RobotChoice& choice) {
  RobotRequest request{choice.robot, choice.srdf, choice.group};
  request.standing = choice.standing;
  for (const std::string& text : choice.fixed) {
    const std::size_t equals = text.find('=');
    if (equals == 0) throw std::invalid_argument("--fix: expected JOINT=VALUE, got " + quote(text));
    if (equals == std::string::npos) {
      request.fixed_states.push_back(text);
      continue;
    }
    const std::string joint = text.substr(0, equals);
    const std::vector<double> values = parse_numbers(text.substr(equals + 1), "--fix " + quote(joint));
    if (values.size() != 1)
      throw std::invalid_argument("--fix " + quote(joint) + ": got " + counted(values.size(), "value") +
                                  ", expected one");
    if (!request.fixed.emplace(joint, values.front()).second)
      throw std::invalid_argument("--fix: joint " + quote(joint) + " is given twice, expected it once");
  }
  for (const std::string& text : choice.packages) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw std::invalid_argument("--package: expected NAME=DIR, got " + quote(text));
    const std::filesystem::path folder = text.substr(equals + 1);
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error))
      throw std::invalid_argument("--package " + quote(text.substr(0, equals)) + ": there is no folder " +
                                  quote_path(folder.string()));
    request.packages[text.substr(0, equals)] = folder;
  }
  for (const std::string& text : choice.xacro) {
    const std::size_t sign = text.find(":=");
    const std::string name = text.substr(0, sign);
    if (sign == std::string::npos || !is_xacro_name(name))
      throw std::invalid_argument(
          "--xacro: expected NAME:=VALUE with a name of letters, digits and underscores, got " + quote(text));
    if (!request.xacro.emplace(name, text.substr(sign + 2)).second)
      throw std::invalid_argument("--xacro: argument " + quote(name) + " is given twice, expected it once");
  }
  return request;
}

Configuration resting_configuration(const Robot& robot) {
  Configuration q = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j)
    q[static_cast<Eigen::Index>(j)] = std::clamp(0.0, robot.joints[j].lower, robot.joints[j].upper);
  return q;
}

namespace {

/// Where joints rest.
Configuration default_configuration(const Robot& robot) {
  const Configuration zero = resting_configuration(robot);
  return moving_joints_of(robot, "default", zero).value_or(zero);
}

/// "--goal: state 'half' does not name joint shoulder (0.2), which stays where the stop before has it"
std::string open_joints_note(const Robot& robot, const std::string& state, const std::string& flag,
                             const Configuration& q) {
  std::vector<std::string> names;
  for (const std::size_t j : joints_left_open(robot, state))
    names.push_back(shortened(robot.joints[j].name) + " (" + significant(q[static_cast<Eigen::Index>(j)]) +
                    ")");
  if (names.empty()) return "";
  const bool is_one = names.size() == 1;
  return flag + ": state " + quote(state) + " does not name joint" + (is_one ? " " : "s ") + listed(names) +
         (is_one ? ", which stays where " : ", which stay where ") +
         (flag == "--start" ? "the robot rests"
                            : "the stop before has " + std::string(is_one ? "it" : "them"));
}

}  // namespace

ChosenStops choose_stops(const std::string& start, const std::vector<std::string>& goals, const Robot& robot,
                         bool degrees, const Configuration& before) {
  ChosenStops stops;
  const auto choose = [&](const std::string& text, const std::string& flag, const auto& others) {
    if (joints_left_open(robot, text).empty()) return choose_configuration(text, flag, robot, degrees);
    const Configuration known = others();
    if (known.size() != static_cast<Eigen::Index>(robot.dof()))
      return choose_configuration(text, flag, robot, degrees);
    const Configuration q = *named_configuration(robot, text, known);
    stops.notes.push_back(open_joints_note(robot, text, flag, q));
    return q;
  };
  stops.start =
      start.empty() ? before : choose(start, "--start", [&] { return default_configuration(robot); });
  for (const std::string& goal : goals)
    stops.goals.push_back(
        choose(goal, "--goal", [&] { return stops.goals.empty() ? stops.start : stops.goals.back(); }));
  return stops;
}

Configuration choose_configuration(const std::string& text, const std::string& flag, const Robot& robot,
                                   bool degrees) try {
  if (const auto q = named_configuration(robot, text)) return *q;
  return parse_configuration(text, flag, joint_names(robot), prismatic_joints(robot), degrees);
} catch (const std::invalid_argument& error) {
  const bool is_number = !text.empty() && text.find_first_not_of("0123456789+-.eE, \t") == std::string::npos;
  if (is_number || robot.states.empty()) throw;
  std::string names;
  for (const NamedState& state : robot.states) names += (names.empty() ? "" : ", ") + state.name;
  throw std::invalid_argument(std::string(error.what()) + " (states of " + quote_path(robot.srdf.string()) +
                              ": " + shortened(names) + ")");
}

bool looks_like_degrees(const Robot& robot, const Configuration& q) {
  Configuration turned = q;
  bool is_far = false;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    if (robot.joints[j].kind != JointKind::revolute) continue;
    is_far = is_far || std::abs(q[static_cast<Eigen::Index>(j)]) > 2.0 * std::numbers::pi;
    turned[static_cast<Eigen::Index>(j)] *= std::numbers::pi / 180.0;
  }
  return is_far && !limit_violation(robot, q).empty() && limit_violation(robot, turned).empty();
}

std::string degrees_hint(const Robot& robot, const Configuration& q, const std::string& flag) {
  if (!looks_like_degrees(robot, q)) return "";
  return "note: " + flag +
         " is far outside of the joint limits in radians and within them in degrees: "
         "--degrees reads it so";
}

Robot choose_robot(const RobotChoice& choice) {
  Robot robot = load_robot(robot_request(choice));
  if (choice.scale) {
    if (!(*choice.scale >= least_scale && *choice.scale <= most_scale))
      throw std::invalid_argument("--scale: expected a factor from 0.000001 to 1000, got " +
                                  significant(*choice.scale));
    robot = scaled(robot, *choice.scale / robot.scale);
  }
  if (!choice.base.empty()) robot.map_from_base = pose_from_numbers(choice.base, "--base");
  return robot;
}

double choose_padding(const RobotChoice& choice, const Robot& robot) {
  return choice.padding.value_or(robot.position_accuracy);
}

std::vector<std::string> volume_notes(const Robot& robot, const std::vector<LegLoad>& loads,
                                      const Snapshot& map) {
  std::set<std::string> known;
  for (const Body& body : robot.bodies) known.insert(body.part);
  for (const LegLoad& load : loads) known.insert(load.load.name);
  std::vector<std::string> notes;
  for (const PaintedVolume& volume : map.volumes()) {
    const auto& parts = volume.critical_parts;
    const auto is_known = [&](const std::string& part) { return known.contains(part); };
    if (!parts.empty() && std::none_of(parts.begin(), parts.end(), is_known))
      notes.push_back("volume " + quote(volume.label) + " is for " + listed(parts) + ", and robot " +
                      quote(robot.name) + " has no such part: expected some of " +
                      shortened(listed({known.begin(), known.end()})));
  }
  return notes;
}

std::vector<bool> prismatic_joints(const Robot& robot) {
  std::vector<bool> flags;
  for (const Joint& joint : robot.joints) flags.push_back(joint.kind == JointKind::prismatic);
  return flags;
}

ConfigurationSpace padded_space(const Robot& robot, const Snapshot& map, const Policies& policies,
                                double padding, double seen_within) {
  require_seen_within(seen_within, map, part_policies(robot, map, policies));  // which no padding mends
  try {
    return ConfigurationSpace(robot, map, policies, {.padding = padding, .seen_within = seen_within});
  } catch (const std::invalid_argument& error) {
    if (padding == 0.0) throw;
    throw std::invalid_argument("with --padding " + significant(padding) + " (metres): " + error.what());
  }
}

namespace {

Policy policy_of(const std::string& flag, const std::string& text) {
  try {
    return parse_policy(text);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("--policy " + flag + ": " + error.what());
  }
}

}  // namespace

Policies choose_policies(const std::vector<std::string>& texts, const Robot& robot) {
  std::set<std::string> parts;
  for (const Body& body : robot.bodies) parts.insert(body.part);
  Policies policies;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      policies.other = policy_of(text, text);
      policies.critical_by_default = false;
      continue;
    }
    const std::string part = text.substr(0, equals);
    if (!parts.count(part)) {
      throw std::invalid_argument("--policy: robot " + quote(robot.name) + " has no part " + quote(part) +
                                  " (it has " + listed({parts.begin(), parts.end()}) + ")");
    }
    policies.parts[part] = policy_of(text, text.substr(equals + 1));
  }
  return policies;
}

std::string describe_policies(const std::map<std::string, Policy>& policies, double seen_within) {
  std::map<Policy, std::size_t> parts;
  for (const auto& [part, policy] : policies) ++parts[policy];
  if (parts.empty()) return "-";
  const Policy usual = std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
                         return a.second < b.second;
                       })->first;
  std::string text;
  for (const auto& [part, policy] : policies) {
    if (policy != usual) text += shortened(part) + " " + std::string(to_string(policy)) + ", ";
  }
  text += (text.empty() ? "all parts " : "other parts ") + std::string(to_string(usual));
  return text + (seen_within > 0.0 ? ", seen within " + significant(seen_within) + " s" : "");
}

PlannerOptions choose_planner_options(const std::vector<std::string>& texts) {
  PlannerOptions options;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw std::invalid_argument("--set: expected key=value, got " + quote(text));
    }
    const std::string key = text.substr(0, equals), value = text.substr(equals + 1);
    if (value.empty()) {
      throw std::invalid_argument("--set " + text + ": no value is given, expected " + key + "=value");
    }
    const auto [known, is_new] = options.emplace(key, value);
    if (!is_new) {
      throw std::invalid_argument("--set: option " + quote(key) + " is given twice, as " +
                                  quote(known->second) + " and as " + quote(value) + ", expected it once");
    }
  }
  return options;
}

namespace {

/// A beam counts what lies within a step of its goal as reached (Chong 2008, eq. 11): `check` wants the goal
/// itself.
void report_missed_goals(const Plan& plan, std::vector<std::pair<std::string, std::string>>& rows) {
  for (std::size_t i = 0; i < plan.legs.size() && i < plan.goals.size(); ++i) {
    if (plan.legs[i].status != PlanStatus::solved) continue;
    const double missed = largest_difference(plan.legs[i].waypoints.back(), plan.goals[i]);
    if (missed <= contract_tolerance) continue;
    rows.emplace_back("goal " + std::to_string(i + 1),
                      "in reach of one step, not reached: a joint is " + significant(missed, 3) +
                          " rad or m from it; check refuses the plan without --accept-goals");
  }
}

void report_motion(const PlannedMotion& planned, std::vector<std::pair<std::string, std::string>>& rows) {
  rows.emplace_back("motion", significant(planned.motion.duration(), 4) + " s, a point every " +
                                  significant(1000.0 * planned.motion.period) + " ms");
  rows.emplace_back("corners", std::to_string(planned.blended) + " blended, " +
                                   std::to_string(planned.stops) + " with a stop");
  if (!planned.unblended.empty()) {
    std::string legs;
    for (const std::size_t leg : planned.unblended)
      legs += (legs.empty() ? "" : ", ") + std::to_string(leg + 1);
    rows.emplace_back("legs without blends", legs);
  }
  rows.emplace_back("motion check",
                    planned.validation.valid ? "valid" : "REFUSED: " + planned.validation.fault);
  rows.emplace_back("motion clearance", significant(planned.validation.min_clearance * 1000.0, 3) +
                                            " mm to voxels at least, corners blended");
}

}  // namespace

namespace {

std::string check_of(const PathVerdict& validation) {
  if (validation.valid) return "valid";
  if (validation.first_contact.empty()) return "none, because the plan is not whole";
  return "REFUSED: " + validation.first_contact;
}

/// "3 of 6": of all legs those that have a path. Of a pick that ends early nobody knows a last one to a goal.
std::string count_of_legs(const Plan& plan) {
  const auto solved = std::count_if(plan.legs.begin(), plan.legs.end(),
                                    [](const PlanResult& leg) { return leg.status == PlanStatus::solved; });
  const std::size_t all = plan.pick ? std::max(plan.legs.size(), names_of_legs(false).size())
                                    : std::max(plan.legs.size(), plan.goals.size());
  return std::to_string(solved) + " of " + std::to_string(all);
}

/// "approach, reach, lift": the legs that a pick has got.
std::string legs_of_pick(const Plan& plan) {
  const std::vector<std::string> names = names_of_legs(plan.legs.size() > names_of_legs(false).size());
  std::string text;
  for (std::size_t i = 0; i < plan.legs.size(); ++i)
    if (plan.legs[i].status == PlanStatus::solved) text += (text.empty() ? "" : ", ") + names.at(i);
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> plan_figures(const Plan& plan) {
  std::size_t steps = 0, checks = 0;
  double joules = 0.0, rest = 0.0;
  for (const PlanResult& leg : plan.legs) {
    steps += static_cast<std::size_t>(leg.search_steps);
    checks += leg.configurations_checked;
    joules += leg.cost + leg.last_segment_cost;
    rest = leg.final_distance;
  }
  std::vector<std::pair<std::string, std::string>> rows{{"status", std::string(to_string(plan.status()))}};
  if (!plan.explanation().empty()) rows.emplace_back("explanation", plan.explanation());
  if (!plan.waypoints().empty()) {
    if (plan.pick) rows.emplace_back("pick", shortened(plan.pick->object.name) + ": " + legs_of_pick(plan));
    rows.emplace_back("legs", count_of_legs(plan));
    rows.emplace_back("steps", grouped(steps));
    rows.emplace_back(
        "cost", plan.cost_caveat.empty() ? significant(joules, 5) + " J" : "not known: " + plan.cost_caveat);
    rows.emplace_back("final distance", significant(rest, 3) + " rad or m from the goal, in joint space");
    report_missed_goals(plan, rows);
    rows.emplace_back("check", check_of(plan.validation));
    if (plan.validation.valid)
      rows.emplace_back("path clearance", significant(plan.validation.min_clearance * 1000.0, 3) +
                                              " mm to voxels at least, along straight edges");
  }
  if (plan.motion) report_motion(*plan.motion, rows);
  if (!plan.motion_caveat.empty()) rows.emplace_back("smooth motion", "none: " + plan.motion_caveat);
  if (!plan.map_integration.empty()) rows.emplace_back("map integration", plan.map_integration);
  if (!plan.map_caveat.empty()) rows.emplace_back("note", plan.map_caveat);
  for (const LegLoad& load : plan.loads) rows.emplace_back("load", describe_load(load));
  if (!plan.tip.empty()) rows.emplace_back("tip", describe_tip(plan.tip));
  rows.emplace_back("policy", describe_policies(plan.policies, plan.seen_within));
  rows.emplace_back("padding", describe_padding(plan.padding, plan.position_accuracy));
  if (plan.survey) {
    for (auto& row : survey_figures(*plan.survey)) rows.push_back(std::move(row));
  }
  rows.emplace_back("configurations", grouped(checks));
  rows.emplace_back("time", significant(plan.time_s, 3) + " s");
  return rows;
}

std::string joined(const std::string& remark, const std::string& other) {
  return remark + (remark.empty() || other.empty() ? "" : "; ") + other;
}

}  // namespace clearway
