#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "apps/console/commands.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/table.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/inspect/map_folder.hpp"
#include "apps/pages/report.hpp"
#include "apps/query/query.hpp"
#include "apps/teach/session_folder.hpp"
#include "apps/teach/teach_session.hpp"
#include "datasets/pictures/video.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check.hpp"
#include "planning/files/query_record.hpp"
#include "planning/files/trajectory_file.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/planner_table.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The events of a file as they fall due.
TeachSession::EventSource script(std::vector<TeachEvent> events) {
  return [events = std::move(events), next = std::size_t{0}](double until) mutable {
    std::vector<TeachEvent> due;
    while (next < events.size() && events[next].time <= until) due.push_back(events[next++]);
    return due;
  };
}

std::string line_of(const TaughtEvent& told) {
  std::string line = significant(told.event.time, 6) + " s  " + std::string(to_string(told.event.action));
  if (!told.event.name.empty()) line += " " + told.event.name;
  if (!told.refusal.empty()) return line + ": refused: " + told.refusal;
  return line + (told.remark.empty() ? "" : ": " + told.remark) + "  [" + std::string(to_string(told.state)) +
         "]";
}

QueryTerms terms_of(const TaughtPlan& taught) {
  const ConfigurationSpace& space = *taught.space;
  return {.name = taught.name,
          .robot = taught.robot.robot,
          .scale = space.robot().scale,
          .map_from_base = space.robot().map_from_base,
          .policies = space.policies(),
          .padding = space.options().padding,
          .seen_within = space.options().seen_within,
          .allow_outside = {},
          .start = taught.start,
          .goals = taught.plan.goals};
}

/// What a session leaves in its folder.
class TaughtFolder {
 public:
  TaughtFolder(const fs::path& folder, const Snapshot& map, std::vector<TaughtPlan>& plans)
      : folder_(folder), map_(map), digest_(map_sha256(map)), plans_(plans) {}

  /// The plans, each with the map that it rests on: the last one, or one of its own under maps/.
  std::vector<ReplayPlan> save() {
    std::vector<ReplayPlan> report;
    QueryRecord record{digest_, {}};
    for (TaughtPlan& taught : plans_) {
      const bool rests_on_last = taught.map_digest == digest_;
      if (rests_on_last)
        record.queries.push_back(terms_of(taught));
      else
        save_own_map(taught);
      const fs::path file = fs::path("plans") / (taught.name + ".json");
      save_file(folder_ / file, to_json(taught.plan));
      report.push_back({taught.name, taught.plan, taught.start, file, taught.space.get()});
      if (taught.is_approved) export_approved(taught);
    }
    if (!record.queries.empty()) save_file(folder_ / "queries.json", to_json(record));
    return report;
  }

  /// What became of approved plans that rest on an earlier map; empty when all hold.
  const std::vector<std::string>& broken() const { return broken_; }

 private:
  void save_own_map(TaughtPlan& taught) {
    const fs::path place = fs::path("maps") / taught.name;
    save_map(taught.space->map(), folder_ / place);
    save_file(folder_ / place / "queries.json", to_json(QueryRecord{taught.map_digest, {terms_of(taught)}}));
    taught.plan.map_file = place.string();
    if (!taught.is_approved) return;
    const ConfigurationSpace& space = *taught.space;
    const PathVerdict verdict = check_path(space.robot(), map_, space.policies(), space.options().padding,
                                           taught.plan.waypoints(), 0.0, space.options().seen_within);
    if (!verdict.valid)
      broken_.push_back("plan '" + taught.name +
                        "' was approved, but does not hold on the last map: " + verdict.first_contact);
  }

  void export_approved(const TaughtPlan& taught) const {
    const Robot& robot = taught.space->robot();
    const Trajectory motion = time_parameterize(robot, taught.plan.waypoints());
    fs::create_directories(folder_ / "approved");
    for (const TrajectoryFormat& format : trajectory_formats()) {
      if (!format.refusal(robot).empty()) continue;
      const std::string extension = format.name == "ros" ? ".yaml" : "." + std::string(format.name);
      save_file(folder_ / "approved" / (taught.name + extension), format.write(robot, taught.plan, motion));
    }
  }

  const fs::path folder_;
  const Snapshot& map_;
  const std::string digest_;
  std::vector<TaughtPlan>& plans_;
  std::vector<std::string> broken_;
};

Json events_json(const TeachSession& session) {
  Json json = Json::array();
  for (const TaughtEvent& told : session.events()) {
    if (told.is_late) continue;
    Json event = Json::parse(to_json_line(told.event));
    event["state"] = to_string(told.state);
    if (!told.refusal.empty()) event["refused"] = told.refusal;
    if (!told.remark.empty()) event["remark"] = told.remark;
    json.push_back(std::move(event));
  }
  return json;
}

Json teaching_json(const TeachSession& session, const std::vector<TaughtPlan>& plans,
                   const std::string& digest) {
  Json json{{"events", events_json(session)},
            {"images_leading_the_robot", session.led_images()},
            {"of_these_warned", session.warned_images()},
            {"plans", Json::array()}};
  for (const TaughtPlan& plan : plans)
    json["plans"].push_back({{"name", plan.name},
                             {"approved", plan.is_approved},
                             {"map", plan.map_digest == digest ? "map.ot" : "maps/" + plan.name}});
  return json;
}

/// Settings of a session that is done again, else of a new one.
RecordedSession session_of(const TeachCommand& command) {
  if (is_session_folder(command.source)) return load_session(command.source);
  RecordedSession session;
  session.source = command.source;
  session.resolution = command.resolution;
  session.integration = command.integration;
  session.seed = command.seed;
  session.time_limit = command.time_limit;
  if (command.setup.empty()) return session;
  session.setup_file = shipped_file("setups", command.setup);
  session.setup_text = read_text(session.setup_file, "setup");
  return session;
}

fs::path events_file(const TeachCommand& command) {
  if (is_session_folder(command.source)) return command.source / "events.jsonl";
  if (command.events.empty())
    throw std::invalid_argument("teach: expected --events FILE, one action a line (see datasets/FORMATS.md)");
  return command.events;
}

}  // namespace

int run_teach(const TeachCommand& command, Console& console) {
  RecordedSession recorded = session_of(command);
  std::vector<TeachEvent> events = load_teach_events(events_file(command));
  for (const TeachEvent& event : events)
    if (event.action == TeachAction::plan) make_planner(event.planner, event.options);
  ChosenSetup setup = setup_of(recorded);
  AtomicFolder folder(command.out, is_in_map_folder);  // refuses before the work what cannot be written
  for (const char* part : {"plans", "session/source"}) fs::create_directories(folder.path() / part);

  TeachSession session(script(std::move(events)),
                       {.seed = recorded.seed,
                        .time_limit = recorded.time_limit,
                        .save = [&](const std::string& name,
                                    const Snapshot& map) { save_map(map, folder.path() / "maps" / name); },
                        .tell = [&](const TaughtEvent& told) { console.log(line_of(told)); }});
  FusionOptions options{.setup_file = setup.source,
                        .resolution = recorded.resolution,
                        .integration = recorded.integration,
                        .threads = command.threads,
                        .camera_seconds = command.camera_seconds,
                        .guide = &session,
                        .setup = setup.setup};
  const bool is_camera = is_camera_name(recorded.source);
  if (is_camera) options.frames_file = folder.path() / "session" / "source" / "frames.rawlog";
  Fusion fusion = fuse(recorded.source, options, console.bar("teaching"));
  session.finish();
  if (is_camera) recorded.source = options.frames_file;
  save_session(recorded, folder.path() / "session");
  save_session_events(session.events(), folder.path() / "session");

  ReplayReport report;
  report.recording = fs::path("session") / "source" / fs::weakly_canonical(recorded.source).filename();
  report.fusion = &fusion;
  report.timings = {{"read", fusion.counts.read_s},
                    {"track", fusion.counts.track_s},
                    {"paint", fusion.counts.paint_s},
                    {"insert", fusion.counts.insert_s}};
  report.map = fusion.map.snapshot();
  save_map(report.map, folder.path());
  report.provenance = fusion.map.provenance();
  save_provenance(report.provenance, folder.path());
  std::vector<TaughtPlan> plans = session.plans();
  TaughtFolder taught(folder.path(), report.map, plans);
  report.plans = taught.save();
  fusion.warnings.insert(fusion.warnings.end(), taught.broken().begin(), taught.broken().end());
  report.teaching = teaching_json(session, plans, map_sha256(report.map))
                        .dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string json = report_json(report);
  save_file(folder.path() / "report.json", json);
  save_file(folder.path() / "report.html", report_html(report, json));
  publish_map_folder(folder, report.map);

  const auto approved =
      std::count_if(plans.begin(), plans.end(), [](const TaughtPlan& p) { return p.is_approved; });
  const auto refused = std::count_if(session.events().begin(), session.events().end(),
                                     [](const TaughtEvent& told) { return !told.refusal.empty(); });
  for (const std::string& warning : fusion.warnings) console.warn("warning: " + warning);
  if (fusion.damage) console.warn("clearway: " + *fusion.damage);
  if (console.json) {
    console.out() << json;
  } else {
    auto rows = report_figures(report);
    rows.emplace_back("events",
                      std::to_string(session.events().size()) + ", refused " + std::to_string(refused));
    rows.emplace_back("plans", std::to_string(plans.size()) + ", approved " + std::to_string(approved));
    print_rows(console.out(), rows);
    for (const TaughtEvent& told : session.events())
      if (!told.refusal.empty()) console.out() << "  " << line_of(told) << '\n';
    console.out() << "\n  report: " << (command.out / "report.html").string() << '\n';
  }
  if (fusion.damage) return exit_damaged;
  const bool all_hold = taught.broken().empty();
  return all_hold && (approved > 0 || plans.empty()) ? exit_done : exit_no;
}

}  // namespace clearway
