#include "planning/files/plan_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "mapping/system/number_text.hpp"
#include "planning/files/csv_field.hpp"
#include "planning/files/joint_order.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/load_json.hpp"
#include "planning/path/path_pieces.hpp"
#include "planning/problem/held_to_task.hpp"
#include "planning/problem/option_reader.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

std::string verdict_of(const PathVerdict& validation) {
  if (validation.valid) return "valid";
  if (validation.undecided) return "undecided";
  return validation.first_contact.empty() ? "not_checked" : "refused";
}

Json validation_json(const Plan& plan) {
  const PathVerdict& validation = plan.validation;
  const std::string verdict = verdict_of(validation);
  Json json = {
      {"verdict", verdict}, {"min_clearance_m", validation.min_clearance}, {"checker", validation.checker}};
  if (!validation.first_contact.empty()) {
    json["first_contact"] = validation.first_contact;
    json["edge"] = validation.edge;
    json["parameter"] = validation.parameter;
  }
  if (!validation.clearance.empty()) json["clearance_m"] = validation.clearance;
  if (plan.survey) json.update(Json::parse(to_json(*plan.survey)));
  return json;
}

/// Runs of waypoints that the planner got to in the same way, each up to the waypoint `to` of the leg.
Json phases_json(const std::vector<WaypointOrigin>& origins) {
  Json runs = Json::array();
  for (std::size_t i = 1; i < origins.size(); ++i) {
    const WaypointOrigin &origin = origins[i], &before = origins[i - 1];
    if (i > 1 && origin.phase == before.phase && origin.constraint == before.constraint) {
      runs.back()["to"] = i;
      continue;
    }
    runs.push_back({{"to", i}, {"phase", to_string(origin.phase)}});
    if (!origin.constraint.empty()) runs.back()["constraint"] = origin.constraint;
  }
  return runs;
}

/// How the planner got to the leg's waypoints, where it says so.
void add_origins(const std::vector<WaypointOrigin>& origins, Json& leg) {
  if (origins.size() < 2) return;
  leg["phases"] = phases_json(origins);
  std::vector<int> steps;
  for (const WaypointOrigin& origin : origins) steps.push_back(origin.search_step);
  if (std::any_of(steps.begin(), steps.end(), [](int step) { return step > 0; })) leg["steps"] = steps;
}

/// `first` is the index of the leg's first waypoint in the whole path.
Json leg_json(const PlanResult& leg, std::size_t first) {
  Json json = {{"status", to_string(leg.status)}, {"explanation", leg.explanation}};
  if (leg.waypoints.empty()) {
    json["waypoints"] = nullptr;
    json["explored"] = json_of(leg.explored);
  } else {
    json["waypoints"] = {first, first + leg.waypoints.size() - 1};
  }
  json["cost_joules"] = leg.cost;
  json["last_segment"] = leg.last_segment;
  json["last_segment_joules"] = leg.last_segment_cost;
  json["length_rad"] = joint_space_length(leg.waypoints);
  json["final_distance_rad"] = leg.final_distance;
  json["search_steps"] = leg.search_steps;
  json["checks"] = leg.configurations_checked;
  json["edges_checked"] = leg.edges_checked;
  std::map<std::string, double> statistics = with_stage(leg.statistics, leg.solved_by);
  std::erase_if(statistics, [](const auto& entry) { return !std::isfinite(entry.second); });  // JSON has none
  json["statistics"] = statistics;
  add_origins(leg.origins, json);
  return json;
}

Json legs_json(const std::vector<PlanResult>& legs) {
  Json json = Json::array();
  std::size_t first = 0;
  for (const PlanResult& leg : legs) {
    json.push_back(leg_json(leg, first));
    if (!leg.waypoints.empty()) first += leg.waypoints.size() - 1;
  }
  return json;
}

Json paint_json(const std::vector<PaintHint>& hints) {
  Json json = Json::array();
  for (const auto& [sphere, part] : hints) {
    json.push_back(
        {{"part", part}, {"center", json_of(Eigen::VectorXd(sphere.center))}, {"radius", sphere.radius}});
  }
  return json;
}

Json motion_json(const PlannedMotion& planned, bool has_loads) {
  Json json = {{"period_s", planned.motion.period},
               {"duration_s", planned.motion.duration()},
               {"speed", planned.scales.speed},
               {"acceleration", planned.scales.acceleration},
               {"jerk", planned.scales.jerk},
               {"verdict", planned.validation.valid ? "valid" : "refused"},
               {"min_clearance_m", planned.validation.min_clearance},
               {"leg_ends", planned.leg_ends},
               {"positions", json_of(planned.motion.positions)},
               {"velocities", json_of(planned.motion.velocities)}};
  if (has_loads) json["grip_time_s"] = planned.grip_time;
  return json;
}

template <typename Value>
Value total(const std::vector<PlanResult>& legs, Value PlanResult::*figure) {
  Value sum{};
  for (const PlanResult& leg : legs) sum += leg.*figure;
  return sum;
}

}  // namespace

PlanStatus Plan::status() const {
  for (const PlanResult& leg : legs) {
    if (leg.status != PlanStatus::solved) return leg.status;
  }
  return legs.empty() ? PlanStatus::no_path : PlanStatus::solved;
}

bool Plan::is_proved() const {
  return status() == PlanStatus::solved && validation.valid && end_violation(true).empty();
}

std::string Plan::end_violation(bool by_goal_box) const {
  const auto path_has = [](const char* verb, const Configuration& found, const Configuration& asked) {
    const double off = found.size() == asked.size() ? (found - asked).lpNorm<Eigen::Infinity>()
                                                    : std::numeric_limits<double>::quiet_NaN();
    return off <= contract_tolerance
               ? std::string()
               : std::string("the path ") + verb + " " + short_text(off, 3) + " (rad or m) from it";
  };
  const std::vector<Configuration> at = stops();
  if (start.size() > 0 && !at.empty())
    if (const std::string off = path_has("begins", at.front(), start); !off.empty()) return "start: " + off;
  if (goals.empty()) return {};
  const std::size_t reached = at.empty() ? 0 : at.size() - 1;
  const std::string count = std::to_string(goals.size());
  if (reached != goals.size())
    return "goals: expected a leg to each of " + count + ", the path has " + std::to_string(reached);
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const std::string off = path_has("ends its leg", at[i + 1], goals[i]);
    if (off.empty()) continue;
    const bool is_comparable = at[i + 1].size() == goals[i].size();
    if (by_goal_box && is_comparable && ends_in_goal_box(planner, legs[i], goals[i])) continue;
    return "goal " + std::to_string(i + 1) + " of " + count + ": " + off;
  }
  return {};
}

std::string Plan::explanation() const {
  const bool is_solved = status() == PlanStatus::solved;
  std::string text;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    if (legs[i].explanation.empty() || (!is_solved && legs[i].status == PlanStatus::solved)) continue;
    text += text.empty() ? "" : " ";
    if (goals.size() > 1) text += "Leg " + std::to_string(i + 1) + ": ";
    text += legs[i].explanation;
  }
  return text;
}

std::vector<Configuration> Plan::waypoints() const {
  std::vector<Configuration> path;
  for (const PlanResult& leg : legs) {
    if (leg.waypoints.empty()) break;
    const bool is_joined = !path.empty() && path.back() == leg.waypoints.front();
    path.insert(path.end(), leg.waypoints.begin() + (is_joined ? 1 : 0), leg.waypoints.end());
  }
  return path;
}

std::vector<WaypointOrigin> Plan::origins() const {
  std::vector<WaypointOrigin> whole;
  const Configuration* end = nullptr;
  for (const PlanResult& leg : legs) {
    if (leg.waypoints.empty()) break;
    std::vector<WaypointOrigin> own = leg.origins;
    own.resize(leg.waypoints.size());
    const bool is_joined = end != nullptr && *end == leg.waypoints.front();
    whole.insert(whole.end(), own.begin() + (is_joined ? 1 : 0), own.end());
    end = &leg.waypoints.back();
  }
  return whole;
}

std::vector<LegsToCheck> legs_of(const Plan& plan, const Robot& robot, const Snapshot& map) {
  require_joint_order(robot, plan);
  const auto names = [&](int leg) {
    std::vector<std::string> riding;
    for (const LegLoad& load : plan.loads)
      if (load.rides_on(leg)) riding.push_back(load.load.name);
    return riding;
  };
  std::vector<LegsToCheck> parts;
  for (int leg = 0; leg < static_cast<int>(plan.legs.size()); ++leg) {
    const std::vector<Configuration>& path = plan.legs[static_cast<std::size_t>(leg)].waypoints;
    if (path.empty()) break;
    if (parts.empty() || names(leg) != names(leg - 1))
      parts.push_back({robot_of_leg(robot, plan.loads, leg), map, {}});
    std::vector<Configuration>& joined = parts.back().waypoints;
    const bool is_joined = !joined.empty() && joined.back() == path.front();
    joined.insert(joined.end(), path.begin() + (is_joined ? 1 : 0), path.end());
  }
  if (parts.empty()) parts.push_back({robot_of_leg(robot, plan.loads, 0), map, {}});
  return parts;
}

PickToCheck pick_of(const Plan& plan, const Pick& pick, const Robot& robot, const Snapshot& map) {
  require_joint_order(robot, plan);
  PickToCheck check{robot, map, pick, Eigen::Isometry3d::Identity(), {}};
  for (const LegLoad& load : plan.loads)
    if (load.load.name == pick.object.name) check.link_from_load = load.load.link_from_load;
  for (const PlanResult& leg : plan.legs)
    if (!leg.waypoints.empty()) check.legs.push_back(leg.waypoints);
  return check;
}

MotionToCheck motion_to_check(const Plan& plan, const Robot& robot) {
  const PlannedMotion& planned = *plan.motion;
  return {planned.motion, planned.leg_ends, plan.stops(), rate_limits(robot, planned.scales),
          planned.grip_time};
}

std::vector<Configuration> Plan::stops() const {
  std::vector<Configuration> stops;
  for (const PlanResult& leg : legs) {
    if (leg.waypoints.empty()) break;
    if (stops.empty()) stops.push_back(leg.waypoints.front());
    stops.push_back(leg.waypoints.back());
  }
  return stops;
}

std::string to_json(const Plan& plan) {
  const std::vector<Configuration> path = plan.waypoints();
  Json json = {
      {"robot", plan.robot},
      {"joints", plan.joints},
      {"planner", plan.planner},
      {"options", plan.options},
      {"seed", plan.seed},
      {"map", {{"file", plan.map_file}, {"sha256", plan.map_sha256}, {"resolution", plan.map_resolution}}},
      {"policy", json_of(plan.policies)},
      {"status", to_string(plan.status())},
      {"explanation", plan.explanation()},
      {"waypoints", json_of(path)},
      {"cost_joules", total(plan.legs, &PlanResult::cost)},
      {"length_rad", joint_space_length(path)},
      {"search_steps", total(plan.legs, &PlanResult::search_steps)},
      {"legs", legs_json(plan.legs)},
      {"time_s", plan.time_s},
      {"checks", total(plan.legs, &PlanResult::configurations_checked)},
      {"validation", validation_json(plan)},
      {"last_segment_joules", total(plan.legs, &PlanResult::last_segment_cost)},
      {"edges_checked", total(plan.legs, &PlanResult::edges_checked)},
      {"goals", json_of(plan.goals)},
      {"scale", plan.robot_scale},
      {"base", json_of(plan.map_from_base)},
      {"padding_m", plan.padding},
      {"position_accuracy_m", plan.position_accuracy},
      {"allow_outside", plan.allow_outside},
      {"payload_kg", plan.payload},
      {"gravity", json_of(Eigen::VectorXd(plan.gravity))}};
  if (plan.motion) json["motion"] = motion_json(*plan.motion, !plan.loads.empty());
  if (!plan.cost_caveat.empty()) json["cost_caveat"] = plan.cost_caveat;
  if (!plan.loads.empty()) json["loads"] = json_of(plan.loads);
  if (plan.pick) json["pick"] = json_of(*plan.pick);
  if (!plan.tip.empty()) json["tip"] = plan.tip;
  if (!plan.group.empty()) json["group"] = plan.group;
  if (!plan.held.empty()) json["held"] = plan.held;
  if (!plan.xacro.empty()) json["xacro"] = plan.xacro;
  if (!plan.query.empty()) json["query"] = plan.query;
  if (plan.start.size() > 0) json["start"] = json_of(plan.start);
  if (plan.seen_within > 0.0) json["seen_within_s"] = plan.seen_within;
  if (!plan.map_integration.empty()) json["map"]["integration"] = plan.map_integration;
  if (!plan.map_caveat.empty()) json["validation"]["map_caveat"] = plan.map_caveat;
  if (!plan.paint.empty()) json["paint"] = paint_json(plan.paint);
  // Bytes that are not UTF-8 (a file name) are replaced rather than refused.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_csv(const Plan& plan) {
  std::string text;
  for (const std::string& joint : plan.joints) text += (text.empty() ? "" : ",") + csv_field(joint);
  text += "\n";
  for (const Configuration& q : plan.waypoints()) {
    text += to_text(std::vector<double>(q.begin(), q.end())) + "\n";
  }
  return text;
}

}  // namespace clearway
