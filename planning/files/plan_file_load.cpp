#include <algorithm>
#include <nlohmann/json.hpp>

#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"
#include "planning/files/load_json.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/path/trajectory.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

PlanStatus status(const JsonField& field) {
  const std::string text = field.text();
  for (const PlanStatus known : {PlanStatus::solved, PlanStatus::start_invalid, PlanStatus::goal_invalid,
                                 PlanStatus::no_path, PlanStatus::timed_out}) {
    if (text == to_string(known)) return known;
  }
  field.refuse("solved, start_invalid, goal_invalid, no_path or timed_out, found " + quote(text));
}

/// The leg's share of the whole path: "waypoints": [first, last], both included.
std::vector<Configuration> share(const JsonField& field, const std::vector<Configuration>& whole) {
  const std::vector<JsonField> ends = field.items();
  if (ends.size() != 2) field.refuse("the first and the last index of the leg's waypoints");
  const std::uint64_t first = ends[0].count(), last = ends[1].count();
  if (first > last || last >= whole.size()) {
    field.refuse("indices of the " + std::to_string(whole.size()) + " waypoints, first <= last");
  }
  return {whole.begin() + static_cast<std::ptrdiff_t>(first),
          whole.begin() + static_cast<std::ptrdiff_t>(last) + 1};
}

/// How the planner got to so many waypoints, where the leg says so (see add_origins in plan_file.cpp). None
/// where that does not fit the waypoints, which somebody may have changed: they are a plan all the same.
std::vector<WaypointOrigin> origins(const JsonField& leg, std::size_t waypoints) {
  if (!leg.has("phases")) return {};
  std::vector<WaypointOrigin> origins(1);  // the first waypoint has none
  for (const JsonField& run : leg.at("phases").items()) {
    WaypointOrigin origin{path_phase(run.at("phase").text())};
    if (origin.phase == PathPhase::unknown && run.at("phase").text() != "unknown")
      run.at("phase").refuse("a phase that clearway writes, found " + quote(run.at("phase").text()));
    if (run.has("constraint")) origin.constraint = run.at("constraint").text();
    const std::uint64_t to = run.at("to").count();
    if (to >= waypoints || to < origins.size()) return {};
    origins.resize(to + 1, origin);
  }
  if (origins.size() != waypoints) return {};
  if (!leg.has("steps")) return origins;
  const std::vector<JsonField> steps = leg.at("steps").items();
  for (std::size_t i = 0; i < waypoints && i < steps.size(); ++i)
    origins[i].search_step = steps[i].whole_number();
  return origins;
}

PlanResult leg(const JsonField& field, const std::vector<Configuration>& whole, std::size_t dof) {
  PlanResult result;
  result.status = status(field.at("status"));
  result.explanation = field.at("explanation").text();
  const JsonField waypoints = field.at("waypoints");
  if (!waypoints.is_null()) result.waypoints = share(waypoints, whole);
  const bool has_path = !result.waypoints.empty();
  if (has_path != (result.status == PlanStatus::solved)) waypoints.refuse("waypoints exactly when solved");
  if (field.has("explored")) result.explored = field.at("explored").vectors(dof);
  result.cost = field.at("cost_joules").number();
  result.search_steps = field.at("search_steps").whole_number();
  if (field.has("last_segment")) result.last_segment = field.at("last_segment").flag();
  if (field.has("last_segment_joules")) result.last_segment_cost = field.at("last_segment_joules").number();
  if (field.has("final_distance_rad")) result.final_distance = field.at("final_distance_rad").number();
  if (field.has("checks")) result.configurations_checked = field.at("checks").count();
  if (field.has("edges_checked")) result.edges_checked = field.at("edges_checked").count();
  result.origins = origins(field, has_path ? result.waypoints.size() : result.explored.size());
  if (!field.has("statistics")) return result;
  for (const auto& [name, value] : field.at("statistics").members()) result.statistics[name] = value.number();
  result.solved_by = take_stage(result.statistics);
  return result;
}

PathVerdict validation(const JsonField& field) {
  PathVerdict result;
  const std::string verdict = field.at("verdict").text();
  if (verdict != "valid" && verdict != "undecided" && verdict != "refused" && verdict != "not_checked") {
    field.at("verdict").refuse("valid, undecided, refused or not_checked");
  }
  result.valid = verdict == "valid";
  result.undecided = verdict == "undecided";
  result.min_clearance = field.at("min_clearance_m").number();
  result.checker = field.at("checker").text();
  if (field.has("first_contact")) result.first_contact = field.at("first_contact").text();
  if (field.has("edge")) result.edge = field.at("edge").whole_number();
  if (field.has("parameter")) result.parameter = field.at("parameter").number();
  if (!field.has("clearance_m")) return result;
  for (const JsonField& item : field.at("clearance_m").items()) result.clearance.push_back(item.number());
  return result;
}

PaintHint paint_hint(const JsonField& field) {
  PaintHint hint;
  hint.part = field.at("part").text();
  hint.sphere.center = field.at("center").numbers(3);
  hint.sphere.radius = field.at("radius").number();
  if (!(hint.sphere.radius > 0.0)) field.at("radius").refuse("a number above 0");
  return hint;
}

double scale_at(const JsonField& field) {
  const double scale = field.number();
  if (!(scale > 0.0 && scale <= 1.0)) field.refuse("a number above 0, at most 1");
  return scale;
}

PlannedMotion planned_motion(const JsonField& field, std::size_t dof) {
  PlannedMotion planned;
  Motion& motion = planned.motion;
  motion.period = field.at("period_s").number();
  if (!(motion.period >= 1e-4 && motion.period <= 10.0))
    field.at("period_s").refuse("seconds from 0.0001 to 10");
  planned.scales.speed = scale_at(field.at("speed"));
  planned.scales.acceleration = scale_at(field.at("acceleration"));
  planned.scales.jerk = scale_at(field.at("jerk"));
  motion.positions = field.at("positions").vectors(dof);
  motion.velocities = field.at("velocities").vectors(dof);
  if (motion.positions.empty()) field.at("positions").refuse("at least one knot");
  if (motion.velocities.size() != motion.positions.size())
    field.at("velocities").refuse("as many as there are positions");
  for (const JsonField& knot : field.at("leg_ends").items()) {
    const std::size_t end = knot.count();
    if (end >= motion.positions.size() || (!planned.leg_ends.empty() && end < planned.leg_ends.back()))
      knot.refuse("a knot of the motion, not before the leg ahead of it");
    planned.leg_ends.push_back(end);
  }
  if (field.has("grip_time_s")) planned.grip_time = field.at("grip_time_s").number();
  if (!(planned.grip_time >= 0.0 && planned.grip_time <= most_grip_time))
    field.at("grip_time_s").refuse("seconds from 0 to 60");
  motion.accelerations = hermite_accelerations(motion);
  const JsonField verdict = field.at("verdict");
  planned.validation.valid = verdict.text() == "valid";
  if (!planned.validation.valid && verdict.text() != "refused") verdict.refuse("valid or refused");
  planned.validation.min_clearance = field.at("min_clearance_m").number();
  return planned;
}

Plan read_plan(const JsonField& root) {
  Plan plan;
  plan.robot = root.at("robot").text();
  for (const JsonField& joint : root.at("joints").items()) plan.joints.push_back(joint.text());
  if (plan.joints.empty()) root.at("joints").refuse("at least one joint");
  const std::size_t dof = plan.joints.size();
  if (root.has("motion")) plan.motion = planned_motion(root.at("motion"), dof);
  if (root.has("cost_caveat")) plan.cost_caveat = root.at("cost_caveat").text();
  if (root.has("group")) plan.group = root.at("group").text();
  if (root.has("held")) {
    for (const auto& [joint, value] : root.at("held").members()) plan.held[joint] = value.number();
  }
  if (root.has("xacro")) {
    for (const auto& [name, value] : root.at("xacro").members()) plan.xacro[name] = value.text();
  }
  plan.planner = root.at("planner").text();
  for (const auto& [name, value] : root.at("options").members()) plan.options[name] = value.text();
  plan.seed = root.at("seed").count();
  plan.map_file = root.at("map").at("file").text();
  plan.map_sha256 = root.at("map").at("sha256").text();
  plan.map_resolution = root.at("map").at("resolution").number();
  plan.policies = policies_of(root.at("policy"));
  status(root.at("status"));
  const std::vector<Configuration> whole = root.at("waypoints").vectors(dof);
  std::size_t waypoints = 0;  // of all legs: each begins where the one before it ended
  for (const JsonField& item : root.at("legs").items()) {
    plan.legs.push_back(leg(item, whole, dof));
    waypoints += plan.legs.back().waypoints.size();
    if (waypoints > whole.size() + plan.legs.size()) item.refuse("legs that make up all waypoints");
  }
  if (plan.status() != status(root.at("status"))) root.at("status").refuse("the status of the legs");
  if (plan.waypoints() != whole) root.at("legs").refuse("legs that make up all waypoints");
  plan.time_s = root.at("time_s").number();
  plan.validation = validation(root.at("validation"));
  if (root.has("goals")) plan.goals = root.at("goals").vectors(dof);
  if (root.has("tip")) plan.tip = root.at("tip").text();
  if (root.has("query")) plan.query = root.at("query").text();
  if (root.has("start")) plan.start = root.at("start").numbers(dof);
  if (root.has("scale")) plan.robot_scale = scale_of(root.at("scale"));
  if (root.has("base")) plan.map_from_base = pose_of(root.at("base"));
  if (root.has("padding_m")) plan.padding = padding_of(root.at("padding_m"));
  if (root.has("seen_within_s")) plan.seen_within = seen_within_of(root.at("seen_within_s"));
  if (root.has("position_accuracy_m")) plan.position_accuracy = padding_of(root.at("position_accuracy_m"));
  if (root.has("allow_outside")) {
    for (const JsonField& part : root.at("allow_outside").items()) plan.allow_outside.push_back(part.text());
  }
  if (root.has("payload_kg")) plan.payload = payload_of(root.at("payload_kg"));
  if (root.has("loads")) plan.loads = loads_of(root.at("loads"));
  if (root.has("pick")) plan.pick = pick_of(root.at("pick"));
  if (root.has("gravity")) plan.gravity = gravity_of(root.at("gravity"));
  if (!root.has("paint")) return plan;
  for (const JsonField& item : root.at("paint").items()) plan.paint.push_back(paint_hint(item));
  return plan;
}

}  // namespace

Plan load_plan(const std::filesystem::path& file) {
  constexpr std::size_t largest = 64U << 20U;
  const std::string text = read_input(file, "plan file", largest);
  require_json(text, "plan file '" + plain(file.string()) + "'");
  const Json json = Json::parse(text);
  return read_plan(JsonField(json, "plan file " + plain(file.string())));
}

Plan parse_plan(const std::string& text, const std::string& name) {
  require_json(text, name);
  const Json json = Json::parse(text);
  return read_plan(JsonField(json, name));
}

}  // namespace clearway
