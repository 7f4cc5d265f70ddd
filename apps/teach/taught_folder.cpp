#include "apps/teach/taught_folder.hpp"

#include <nlohmann/json.hpp>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "planning/files/query_record.hpp"
#include "planning/files/trajectory_file.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot/joint_names.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

QueryTerms terms_of(const TaughtPlan& taught) {
  const ConfigurationSpace& space = *taught.space;
  return {.name = taught.name,
          .robot = taught.robot.robot,
          .scale = space.robot().scale,
          .map_from_base = space.robot().map_from_base,
          .policies = taught.plan.policies,
          .padding = space.options().padding,
          .seen_within = space.options().seen_within,
          .allow_outside = {},
          .start = taught.start,
          .goals = taught.goals,
          .loads = taught.plan.pick ? std::vector<LegLoad>{} : taught.plan.loads,
          .pick = taught.plan.pick,
          .payload = taught.plan.payload,
          .gravity = taught.plan.gravity,
          .joints = joint_names(space.robot())};
}

Json events_json(const TeachSession& session) {
  Json json = Json::array();
  for (const TaughtEvent& reported : session.events()) {
    if (reported.is_late) continue;
    Json event = Json::parse(to_json_line(reported.event));
    event["state"] = to_string(reported.state);
    if (!reported.refusal.empty()) event["refused"] = reported.refusal;
    if (!reported.remark.empty()) event["remark"] = reported.remark;
    json.push_back(std::move(event));
  }
  return json;
}

/// In words, for the plan's card.
std::string approval_of(const TaughtPlan& taught) {
  if (!taught.is_approved) return "not approved";
  return taught.void_reason.empty() ? "approved"
                                    : "void: does not hold on the last map: " + taught.void_reason;
}

}  // namespace

TaughtFolder::TaughtFolder(const fs::path& folder, const Snapshot& map, std::vector<TaughtPlan>& plans)
    : folder_(folder), map_(map), digest_(map_sha256(map)), plans_(plans) {}

std::vector<ReplayPlan> TaughtFolder::save() {
  std::vector<ReplayPlan> report;
  QueryRecord record{digest_, {}};
  for (TaughtPlan& taught : plans_) {
    const bool rests_on_last = taught.map_digest == digest_;
    if (rests_on_last) record.queries.push_back(terms_of(taught));
    const bool holds = rests_on_last || save_own_map(taught);
    const fs::path file = fs::path("plans") / (taught.name + ".json");
    save_file(folder_ / file, to_json(taught.plan));
    report.push_back({taught.name, taught.plan, taught.start, file, taught.space.get(), approval_of(taught)});
    if (taught.is_approved && holds) export_approved(taught);
  }
  if (!record.queries.empty()) save_file(folder_ / "queries.json", to_json(record));
  return report;
}

bool TaughtFolder::save_own_map(TaughtPlan& taught) {
  const fs::path place = fs::path("maps") / taught.name;
  save_map(taught.space->map(), folder_ / place);
  save_file(folder_ / place / "queries.json", to_json(QueryRecord{taught.map_digest, {terms_of(taught)}}));
  taught.plan.map_file = place.string();
  if (!taught.is_approved) return true;
  const PathVerdict verdict = check_taught(taught, map_);
  if (verdict.valid) return true;
  taught.void_reason = verdict.first_contact;
  broken_.push_back(
      "plan '" + taught.name +
      "' was approved, but does not hold on the last map, and is not exported: " + taught.void_reason);
  return false;
}

void TaughtFolder::export_approved(const TaughtPlan& taught) const {
  const Robot& robot = taught.space->robot();
  const Trajectory motion = trajectory_of(robot, taught.plan);
  fs::create_directories(folder_ / "approved");
  for (const TrajectoryFormat& format : trajectory_formats()) {
    const bool is_for_robots = format.name == "ros" || format.name == "urscript";
    if (!is_for_robots || !format.refusal(robot).empty()) continue;
    const std::string extension = format.name == "ros" ? ".yaml" : "." + std::string(format.name);
    save_file(folder_ / "approved" / (taught.name + extension), format.write(robot, taught.plan, motion));
  }
}

std::string teaching_json(const TeachSession& session, const std::vector<TaughtPlan>& plans,
                          const std::string& digest) {
  Json json{{"events", events_json(session)},
            {"images_leading_the_robot", session.led_images()},
            {"of_these_warned", session.warned_images()},
            {"plans", Json::array()}};
  for (const TaughtPlan& plan : plans)
    json["plans"].push_back({{"name", plan.name},
                             {"approved", plan.is_approved && plan.void_reason.empty()},
                             {"map", plan.map_digest == digest ? "map.ot" : "maps/" + plan.name}});
  for (std::size_t i = 0; i < plans.size(); ++i)
    if (!plans[i].void_reason.empty()) json["plans"][i]["void"] = plans[i].void_reason;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace clearway
