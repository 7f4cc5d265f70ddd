#include "apps/check/check_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/console/parse.hpp"
#include "apps/query/goal_poses.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/query.hpp"
#include "apps/query/survey_figures.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/load_json.hpp"

namespace clearway {

namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::pair<std::string, std::string>>;

std::string_view name_of(AcceptedTerm term) {
  switch (term) {
    case AcceptedTerm::robot:
      return "robot";
    case AcceptedTerm::held:
      return "held";
    case AcceptedTerm::scale:
      return "scale";
    case AcceptedTerm::base:
      return "base";
    case AcceptedTerm::policy:
      return "policy";
    case AcceptedTerm::padding:
      return "padding";
    case AcceptedTerm::load:
      return "load";
    case AcceptedTerm::payload:
      return "payload";
    case AcceptedTerm::map:
      return "map";
    case AcceptedTerm::moving_start:
      return "moving-start";
    case AcceptedTerm::moving_end:
      return "moving-end";
    case AcceptedTerm::goals:
      break;
  }
  return "goals";
}

std::string from(TermSource source) { return " (" + std::string(to_string(source)) + ")"; }

Json numbers(const Configuration& q) { return Json(std::vector<double>(q.begin(), q.end())); }

template <typename Value>
Json term_json(const Value& value, TermSource source) {
  return {{"value", value}, {"source", to_string(source)}};
}

Json contract_json(const Contract& contract) {
  Json json;
  json["robot"] = term_json(contract.robot.value, contract.robot.source);
  if (!contract.group.value.empty()) json["group"] = term_json(contract.group.value, contract.group.source);
  for (const auto& [joint, term] : contract.held) json["held"][joint] = term_json(term.value, term.source);
  json["scale"] = term_json(contract.scale.value, contract.scale.source);
  json["base"] = term_json(numbers_from_pose(contract.map_from_base.value), contract.map_from_base.source);
  json["policy"] = Json::object();
  for (const auto& [part, term] : contract.policies)
    json["policy"][part] = term_json(to_string(term.value), term.source);
  json["padding_m"] = term_json(contract.padding.value, contract.padding.source);
  json["seen_within_s"] = term_json(contract.seen_within.value, contract.seen_within.source);
  if (!contract.loads.value.empty()) {
    json["loads"]["value"] = json_of(contract.loads.value);
    json["loads"]["source"] = to_string(contract.loads.source);
  }
  if (contract.pick.value) {
    json["pick"]["value"] = json_of(*contract.pick.value);
    json["pick"]["source"] = to_string(contract.pick.source);
  }
  if (contract.grip_time.value && !carried_under(contract).empty())
    json["grip_time_s"] = term_json(*contract.grip_time.value, contract.grip_time.source);
  json["payload_kg"] = term_json(contract.payload.value, contract.payload.source);
  json["gravity"] = term_json(numbers(contract.gravity.value), contract.gravity.source);
  json["map_sha256"] = term_json(contract.map_sha256.value, contract.map_sha256.source);
  json["start"] = term_json(numbers(contract.start.value), contract.start.source);
  Json goals = Json::array();
  for (const Configuration& goal : contract.goals.value) goals.push_back(numbers(goal));
  json["goals"] = term_json(goals, contract.goals.source);
  if (!contract.goal_poses.empty()) {
    for (const GoalPose& goal : contract.goal_poses) json["goal_poses"]["value"].push_back(json_of(goal));
    if (!contract.tip.empty()) json["goal_poses"]["tip"] = contract.tip;
    json["goal_poses"]["source"] = to_string(contract.goals.source);
  }
  if (!contract.tip_link.value.empty())
    json["tip"] = term_json(contract.tip_link.value, contract.tip_link.source);
  json["query"] = contract.query.empty() ? Json(nullptr) : Json(contract.query);
  json["notes"] = contract.notes;
  return json;
}

/// "tool painted, other parts known_free (map)"; where sources differ, one after the other.
std::string policy_text(const Contract& contract) {
  std::map<TermSource, std::map<std::string, Policy>> by_source;
  for (const auto& [part, term] : contract.policies) by_source[term.source][part] = term.value;
  if (by_source.size() <= 1) {
    const std::string text = describe_policies(policies_of(contract), 0.0);
    return by_source.empty() ? text : text + from(by_source.begin()->first);
  }
  std::string text;
  for (const auto& [source, policies] : by_source) {
    std::string parts;
    for (const auto& [part, policy] : policies)
      parts += (parts.empty() ? "" : ", ") + shortened(part) + " " + std::string(to_string(policy));
    text += (text.empty() ? "" : "; ") + parts + from(source);
  }
  return text;
}

void append_contract(const Contract& contract, Rows& rows) {
  rows.emplace_back("robot", plain(contract.robot.value) + " at scale " + significant(contract.scale.value) +
                                 from(contract.scale.source));
  if (!contract.group.value.empty())
    rows.emplace_back("group", contract.group.value + from(contract.group.source));
  for (const auto& [joint, term] : contract.held)
    rows.emplace_back("held", shortened(joint) + " at " + significant(term.value) + from(term.source));
  rows.emplace_back("base", to_text(contract.map_from_base.value) + from(contract.map_from_base.source));
  for (const LegLoad& load : contract.loads.value)
    rows.emplace_back("load", describe_load(load) + from(contract.loads.source));
  if (contract.pick.value)
    rows.emplace_back("pick", shortened(contract.pick.value->object.name) + from(contract.pick.source));
  rows.emplace_back("payload", significant(contract.payload.value) + " kg" + from(contract.payload.source));
  rows.emplace_back(
      "gravity", to_text(Configuration(contract.gravity.value)) + " m/s^2" + from(contract.gravity.source));
  if (contract.grip_time.value && !carried_under(contract).empty())
    rows.emplace_back("grip time", significant(*contract.grip_time.value) + " s of a motion" +
                                       from(contract.grip_time.source));
  rows.emplace_back("policy", policy_text(contract));
  if (contract.seen_within.value > 0.0)
    rows.emplace_back("seen within", significant(contract.seen_within.value) +
                                         " s before the map's newest look" +
                                         from(contract.seen_within.source));
  rows.emplace_back("padding", describe_padding(contract.padding.value, contract.position_accuracy,
                                                from(contract.padding.source)));
  rows.emplace_back(
      "map", "sha256 " + contract.map_sha256.value.substr(0, 16) + "…" + from(contract.map_sha256.source));
  rows.emplace_back("start", to_text(contract.start.value) + from(contract.start.source));
  for (const Configuration& goal : contract.goals.value)
    if (goal.size() > 0)
      rows.emplace_back("goal", to_text(goal) + from(contract.goal_poses.empty() ? contract.goals.source
                                                                                 : TermSource::plan));
  for (const GoalPose& goal : contract.goal_poses)
    rows.emplace_back("goal pose", describe_goal_pose(contract.tip, goal) + from(contract.goals.source));
  if (!contract.tip_link.value.empty())
    rows.emplace_back("tip", describe_tip(contract.tip_link.value) + from(contract.tip_link.source));
  if (!contract.query.empty()) rows.emplace_back("query", "'" + contract.query + "' of the map's record");
  for (const std::string& note : contract.notes) rows.emplace_back("note", note);
}

std::string percent(double share) { return significant(100.0 * share, 4) + " %"; }

void append_motion(const MotionVerdict& motion, double duration, Rows& rows) {
  if (!motion.valid) {
    rows.emplace_back("refused for", motion.fault);
    return;
  }
  rows.emplace_back(
      "motion", "valid: " + significant(duration, 4) + " s, at most " + percent(motion.shares.velocity) +
                    " of velocity, " + percent(motion.shares.acceleration) + " of acceleration and " +
                    percent(motion.shares.jerk) + " of jerk limits at " + counted(motion.samples, "sample") +
                    "; clearance at least " + significant(motion.min_clearance * 1000.0, 3) + " mm");
}

void append_splines(const SplineVerdict& splines, double duration, Rows& rows) {
  if (!splines.fault.empty()) {
    rows.emplace_back("refused for", splines.fault);
  } else if (splines.path.valid) {
    std::string shares;
    for (const auto& [share, limits] : {std::pair{splines.velocity_share, " of velocity limits"},
                                        std::pair{splines.acceleration_share, " of acceleration limits"}})
      if (share.value_or(0.0) > 0.0)
        shares += (shares.empty() ? ", at most " : " and ") + percent(*share) + limits;
    rows.emplace_back("motion", "valid: " + significant(duration, 4) + " s" + shares);
  }
}

void append_torques(const TorqueFinding& torques, Rows& rows) {
  if (torques.share != 0.0) rows.emplace_back("torques", "at most " + percent(torques.share) + " of a limit");
  for (const std::string& joint : torques.overloaded)
    rows.emplace_back("note",
                      "gravity alone takes more than 95 % of the torque limit of joint " + shortened(joint));
}

Json unjudged_json(const std::vector<UnjudgedRate>& rates) {
  Json list = Json::array();
  for (const UnjudgedRate& rate : rates) {
    list.push_back({{"rate", rate.rate},
                    {"joints", rate.joints},
                    {"peak", rate.peak.value},
                    {"joint", rate.joint},
                    {"time_s", rate.peak.time},
                    {"sentence", rate.sentence}});
    if (rate.usual > 0.0) list.back()["usual_limit"] = rate.usual;
  }
  return list;
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json splines_json(const SplineVerdict& splines, double duration) {
  return {{"verdict", splines.is_valid()       ? "valid"
                      : !splines.fault.empty() ? "refused"
                      : splines.path.undecided ? "undecided"
                                               : "refused"},
          {"fault", splines.fault},
          {"duration_s", duration},
          {"velocity_share", or_null(splines.velocity_share)},
          {"acceleration_share", or_null(splines.acceleration_share)},
          {"straight_lines", splines.lines},
          {"cubics", splines.cubics},
          {"quintics", splines.quintics}};
}

Json motion_json(const MotionVerdict& motion, double duration) {
  return {{"verdict", motion.valid       ? "valid"
                      : motion.undecided ? "undecided"
                                         : "refused"},
          {"fault", motion.fault},
          {"duration_s", duration},
          {"min_clearance_m", motion.min_clearance},
          {"samples", motion.samples},
          {"velocity_share", motion.shares.velocity},
          {"acceleration_share", motion.shares.acceleration},
          {"jerk_share", motion.shares.jerk}};
}

}  // namespace

bool CheckReport::is_valid() const {
  return path.valid && (!motion || motion->valid) && (!splines || splines->fault.empty()) &&
         std::all_of(deviations.begin(), deviations.end(),
                     [](const Deviation& deviation) { return deviation.is_accepted; });
}

std::string_view CheckReport::word() const {
  if (is_valid()) return "valid";
  const bool is_motion_refused =
      (motion && !motion->valid && !motion->undecided) || (splines && !splines->fault.empty());
  const bool is_undecided = path.undecided || (path.valid && motion && motion->undecided);
  return is_undecided && !is_motion_refused ? "undecided" : "refused";
}

Rows check_rows(const CheckReport& report) {
  Rows rows{{"verdict", std::string(report.word())}};
  for (const Deviation& deviation : report.deviations) {
    if (deviation.is_accepted)
      rows.emplace_back("accepted", deviation.sentence);
    else
      rows.emplace_back("refused for", deviation.sentence + " (--accept-" +
                                           std::string(name_of(deviation.term)) + " accepts it)");
  }
  if (!report.path.first_contact.empty()) rows.emplace_back("first contact", report.path.first_contact);
  if (report.path.valid)
    rows.emplace_back("min. clearance", "at least " + significant(report.path.min_clearance * 1000.0, 3) +
                                            " mm" + (report.motion ? " along straight edges" : ""));
  if (report.motion) append_motion(*report.motion, report.motion_duration, rows);
  if (report.splines) append_splines(*report.splines, report.motion_duration, rows);
  for (const UnjudgedRate& rate : report.unjudged) rows.emplace_back(rate.rate, rate.sentence);
  if (report.torques) append_torques(*report.torques, rows);
  rows.emplace_back("waypoints", std::to_string(report.waypoints));
  for (auto& row : survey_figures(report.survey)) rows.push_back(std::move(row));
  if (report.plan_status != PlanStatus::solved)
    rows.emplace_back("plan", std::string(to_string(report.plan_status)) + ": not all legs have a path");
  append_contract(report.contract, rows);
  rows.emplace_back("map integration", report.map_integration);
  if (!report.torque_caveat.empty()) rows.emplace_back("note", report.torque_caveat);
  if (!report.map_caveat.empty()) rows.emplace_back("note", report.map_caveat);
  rows.emplace_back("checker", report.path.checker);
  return rows;
}

Json check_json(const CheckReport& report) {
  const Contract& contract = report.contract;
  Json json;
  json["verdict"] = report.word();
  json["deviations"] = Json::array();
  for (const Deviation& deviation : report.deviations)
    json["deviations"].push_back({{"term", name_of(deviation.term)},
                                  {"sentence", deviation.sentence},
                                  {"accepted", deviation.is_accepted}});
  json["first_contact"] = report.path.first_contact;
  json["edge"] = report.path.edge;
  json["parameter"] = report.path.parameter;
  json["min_clearance_m"] = report.path.min_clearance;
  if (report.motion) json["motion"] = motion_json(*report.motion, report.motion_duration);
  if (report.splines) {
    json["motion"] = splines_json(*report.splines, report.motion_duration);
    json["motion"]["not_judged"] = unjudged_json(report.unjudged);
  }
  if (report.torques) {
    json["motion"]["torque_share"] = report.torques->share;
    json["motion"]["overloaded_joints"] = report.torques->overloaded;
  }
  for (const auto& [part, term] : contract.policies) json["policy"][part] = to_string(term.value);
  if (contract.seen_within.value > 0.0) json["seen_within_s"] = contract.seen_within.value;
  json["padding_m"] = contract.padding.value;
  json["waypoints"] = report.waypoints;
  json["plan_status"] = to_string(report.plan_status);
  json["scale"] = contract.scale.value;
  json["base"] = numbers_from_pose(contract.map_from_base.value);
  json["same_map"] = std::none_of(report.deviations.begin(), report.deviations.end(),
                                  [](const Deviation& d) { return d.term == AcceptedTerm::map; });
  json["integration"] = report.map_integration;
  if (!report.torque_caveat.empty()) json["torque_caveat"] = report.torque_caveat;
  if (!report.map_caveat.empty()) json["map_caveat"] = report.map_caveat;
  json.update(Json::parse(to_json(report.survey)));
  json["contract"] = contract_json(contract);
  json["checker"] = report.path.checker;
  return json;
}

}  // namespace clearway
