#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>

#include "apps/console/commands.hpp"
#include "apps/console/flag_names.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/quantile.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/table.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/inspect/map_folder.hpp"
#include "apps/overlay/replay_pictures.hpp"
#include "apps/pages/report.hpp"
#include "apps/query/query.hpp"
#include "apps/teach/session_folder.hpp"
#include "apps/teach/shown_session.hpp"
#include "apps/teach/taught_folder.hpp"
#include "apps/teach/teach_keys.hpp"
#include "apps/teach/teach_screen.hpp"
#include "apps/teach/teach_session.hpp"
#include "apps/teach/teach_window.hpp"
#include "datasets/pictures/video.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/planner_table.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// The events of a file as they fall due.
TeachSession::EventSource script(std::vector<TeachEvent> events) {
  return [events = std::move(events), next = std::size_t{0}](double until) mutable {
    std::vector<TeachEvent> due;
    while (next < events.size() && events[next].time <= until) due.push_back(events[next++]);
    return due;
  };
}

/// What of a folder this command writes. Without a list of our files in it nothing but a map is ours: all
/// else may be somebody's only copy.
IsOurs written_into(const fs::path& folder) {
  const bool has_list = fs::exists(folder / own_files_name);
  return [has_list](const fs::path& relative) {
    const fs::path part = *relative.begin();
    const bool is_of_session = part == "session" || part == "approved" || part == "maps";
    return is_in_map_folder(relative) || (has_list && is_of_session);
  };
}

/// Settings of a session that is done again, else of a new one.
RecordedSession session_of(const TeachCommand& command) {
  if (is_session_folder(command.source)) {
    const TeachCommand plain;
    if (!command.setup.empty() || !command.events.empty() || command.resolution != plain.resolution ||
        !command.integration.empty() || command.seed != plain.seed || command.time_limit != plain.time_limit)
      throw std::invalid_argument(
          quote_path(command.source.string()) +
          " is a recorded session, which is done again as it was: expected no --setup, --events, "
          "--resolution, --integration, --seed and --time-limit; with them, give the recording in its "
          "folder 'source'");
    return load_session(command.source);
  }
  RecordedSession session;
  session.source = command.source;
  session.resolution = command.resolution;
  session.integration = command.integration;
  session.seed = command.seed;
  session.time_limit = command.time_limit;
  if (command.setup.empty()) return session;
  session.setup_file = fs::absolute(shipped_file("setups", command.setup));  // as a replay names it
  session.setup_text = read_text(session.setup_file, "setup");
  return session;
}

fs::path events_file(const TeachCommand& command) {
  return is_session_folder(command.source) ? command.source / "events.jsonl" : command.events;
}

/// What keys mean, at the frame before which they are asked for.
/// @param own of --keys
std::vector<TeachEvent> events_of_keys(const std::vector<int>& keys, const std::vector<TeachKey>& own,
                                       const TeachSession& session, double time) {
  std::vector<TeachEvent> events;
  for (const int key : keys) {
    std::optional<TeachEvent> event = event_of_key(key, own, session);
    const auto action = action_of_key(key, session.state());
    if (!event && !action) continue;
    if (!event) {
      event.emplace();
      event->action = *action;
      if (*action == TeachAction::save) event->name = "saved_at_" + significant(time, 6);
      if (*action == TeachAction::object) event->name = "object_at_" + significant(time, 6);
    }
    event->time = time;
    events.push_back(std::move(*event));
  }
  return events;
}

/// The window, where one is wanted and can be.
std::unique_ptr<TeachScreen> open_screen(const TeachCommand& command, Console& console) {
  if (command.headless || is_session_folder(command.source)) return nullptr;
  std::string why = "there is no display";
  if (has_display()) {
    try {
      return std::make_unique<TeachScreen>("clearway teach");
    } catch (const std::runtime_error& error) {
      why = error.what();
    }
  }
  console.log("note: no window: " + why + "; the session goes on without one (--headless)");
  return nullptr;
}

void report_times(const ScreenTimes& times, Console& console) {
  if (times.latencies.empty()) return;
  console.log("window: " + counted(times.latencies.size(), "picture") + ", " + grouped(times.dropped) +
              " left out; from image to picture " + significant(1e3 * quantile(times.latencies, 0.5), 3) +
              " ms (median), " + significant(1e3 * quantile(times.latencies, 0.95), 3) + " ms (95 %)");
}

/// What would leave another planner, robot or load at work than the events say, before the session begins.
/// @param where the event is: "events file 'e.jsonl', at 3 s"
void require_possible(const TeachEvent& event, const Setup& setup, const std::string& where) try {
  if (event.action == TeachAction::plan) make_planner(event.planner, event.options);
  if (event.action == TeachAction::robot) VirtualRobot(event.robot, event.near);
  if (event.action == TeachAction::attach) load_of(event, setup);
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument(where + ", " + std::string(to_string(event.action)) + ": " +
                              with_keys(error.what()));
}

/// Keys are for the window, and for what is done there.
std::vector<TeachKey> keys_of_file(const TeachCommand& command, const Setup& setup) {
  if (command.keys.empty()) return {};
  if (!events_file(command).empty())
    throw std::invalid_argument(
        "--keys: expected no --events, and no recorded session: its actions are known");
  std::vector<TeachKey> keys = load_teach_keys(command.keys);
  for (const TeachKey& key : keys)
    require_possible(
        key.event, setup,
        "keys file " + quote_path(command.keys.string()) + ", key " + quote(std::string(1, key.key)));
  return keys;
}

/// The recording goes into the session's folder as it was: nothing may be written over it or into it.
void require_apart_from(const RecordedSession& recorded, const TeachCommand& command) {
  const fs::path& source = recorded.source;
  require_apart({{"--overlay", command.overlay}, {"--video-out", command.video}},
                {{"SOURCE", command.source},
                 {"the session", source},
                 {"--setup", recorded.setup_file},
                 {"--events", command.events},
                 {"--keys", command.keys}});
  std::error_code error;
  if (!fs::is_directory(source, error)) return;
  const fs::path inner = fs::weakly_canonical(command.out).lexically_relative(fs::weakly_canonical(source));
  if (!inner.empty() && *inner.begin() != "..")
    throw std::invalid_argument("--out: " + quote_path(command.out.string()) +
                                " lies in the recording, the folder " + quote_path(source.string()) +
                                ", expected a place outside of it");
}

/// How far a search came when its clock ended it depends on the machine.
void note_timed_plans(const std::vector<TaughtPlan>& plans, double time_limit, Console& console) {
  for (const TaughtPlan& taught : plans)
    if (taught.plan.status() == PlanStatus::timed_out || taught.plan.time_s >= time_limit)
      console.warn("note: plan " + quote(taught.name) + " took all of its time limit of " +
                   short_text(time_limit) +
                   " s: done again, it may report other counts or find another path");
}

}  // namespace

int run_teach(const TeachCommand& command, Console& console) {
  RecordedSession recorded = session_of(command);
  const fs::path file = events_file(command);
  const InputKeeper keeper(recorded.inputs, {recorded.source, command.source, file}, recorded.folder);
  std::vector<TeachEvent> events = file.empty() ? std::vector<TeachEvent>{} : load_teach_events(file);
  ChosenSetup setup = setup_of(recorded);
  for (const TeachEvent& event : events)
    require_possible(
        event, setup.setup,
        "events file " + quote_path(file.string()) + ", at " + significant(event.time, 6) + " s");
  const std::vector<TeachKey> own_keys = keys_of_file(command, setup.setup);
  const PictureOptions stills{command.overlay, {}};
  const bool is_camera = is_camera_name(recorded.source);
  require_pictures(stills, recorded.source, command.out);
  if (!command.video.empty()) require_writable(command.video);
  require_apart_from(recorded, command);
  const std::unique_ptr<TeachScreen> screen = open_screen(command, console);
  if (!screen && file.empty())
    throw std::invalid_argument(
        "teach: without a window nobody acts; expected --events FILE (see datasets/FORMATS.md)");
  require_no_session(command.out);
  require_no_foreign_map("--out", command.out);
  AtomicFolder folder(command.out,
                      written_into(command.out));  // refuses before the work what cannot be written
  for (const char* part : {"plans", "session/source"}) fs::create_directories(folder.path() / part);

  TeachSession* keyed = nullptr;
  const TeachSession::EventSource keys = [&](double until) {
    return std::isfinite(until) ? events_of_keys(screen->keys(), own_keys, *keyed, until)
                                : std::vector<TeachEvent>{};
  };
  TeachSession session(file.empty() ? keys : script(std::move(events)),
                       {.seed = recorded.seed,
                        .time_limit = recorded.time_limit,
                        .waits_for_plans = !file.empty(),
                        .save = [&](const std::string& name,
                                    const Snapshot& map) { save_map(map, folder.path() / "maps" / name); },
                        .report = [&](const TaughtEvent& reported) { console.log(line_of(reported)); }});
  keyed = &session;
  ShownSession shown(session, screen.get(), command.video, words_of(own_keys));
  FusionOptions options{.setup_file = setup.source,
                        .resolution = recorded.resolution,
                        .integration = recorded.integration,
                        .threads = command.threads,
                        .camera_seconds = command.camera_seconds,
                        .guide = &shown,
                        .setup = setup.setup,
                        .is_paced = screen != nullptr};
  const bool is_live = is_camera || screen != nullptr;
  if (is_live) options.frames_file = folder.path() / "session" / "source" / "frames.rawlog";
  Fusion fusion = fuse(recorded.source, options, console.bar("teaching"));
  shown.finish_film();
  if (screen) report_times(screen->times(), console);
  const fs::path source = recorded.source;
  if (is_live) recorded.source = options.frames_file;
  save_session(recorded, keeper.kept(), folder.path() / "session");
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
  report.pictures = shown.pictures();
  std::vector<TaughtPlan> plans(session.plans().begin(), session.plans().end());
  TaughtFolder taught(folder.path(), report.map, plans);
  report.plans = taught.save();
  fusion.warnings.insert(fusion.warnings.end(), taught.broken().begin(), taught.broken().end());
  report.teaching = teaching_json(session, plans, map_sha256(report.map));
  const std::string json = report_json(report);
  save_file(folder.path() / "report.json", json);
  save_file(folder.path() / "report.html", report_html(report, json));
  publish_map_folder(folder, report.map);
  if (stills.are_asked())
    draw_replay(source, fusion, report.map, report.plans, stills, console.bar("drawing"));

  const auto approved = std::count_if(
      plans.begin(), plans.end(), [](const TaughtPlan& p) { return p.is_approved && p.void_reason.empty(); });
  const std::size_t voided = taught.broken().size();
  const auto refused = std::count_if(session.events().begin(), session.events().end(),
                                     [](const TaughtEvent& reported) { return !reported.refusal.empty(); });
  for (const std::string& warning : fusion.warnings) console.warn("warning: " + warning);
  if (const auto& late = session.late_events(); !late.empty())
    console.warn("note: " + counted(late.size(), "event") + " (the first at " + significant(late.front(), 6) +
                 " s) came after the last image: no image shows what the probes did then");
  note_timed_plans(plans, recorded.time_limit, console);
  if (fusion.damage) console.warn("clearway: " + *fusion.damage);
  if (console.json) {
    console.out() << json;
  } else {
    auto rows = report_figures(report);
    rows.emplace_back("events",
                      std::to_string(session.events().size()) + ", refused " + std::to_string(refused));
    rows.emplace_back("plans", std::to_string(plans.size()) + ", approved " + std::to_string(approved) +
                                   (voided > 0 ? ", approved but void " + std::to_string(voided) : ""));
    print_rows(console.out(), rows);
    for (const TaughtEvent& reported : session.events())
      if (!reported.refusal.empty()) console.out() << "  " << line_of(reported) << '\n';
    console.out() << "\n  report: " << (command.out / "report.html").string() << '\n';
  }
  if (fusion.damage) return exit_damaged;
  const bool is_wanted =
      std::any_of(session.events().begin(), session.events().end(), [](const TaughtEvent& reported) {
        return reported.event.action == TeachAction::plan || reported.event.action == TeachAction::approve;
      });
  if (!taught.broken().empty()) return exit_no;
  if (approved > 0 || !is_wanted) return exit_done;
  console.warn("note: no plan is approved, which the session asked for: exit status 1");
  return exit_no;
}

}  // namespace clearway
