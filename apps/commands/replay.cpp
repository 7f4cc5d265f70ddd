#include <algorithm>
#include <chrono>
#include <memory>
#include <ostream>
#include <set>
#include <stdexcept>

#include "apps/commands/replay_queries.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/table.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/fusion/replay_record.hpp"
#include "apps/inspect/map_folder.hpp"
#include "apps/overlay/replay_pictures.hpp"
#include "apps/pages/report.hpp"
#include "apps/teach/session_folder.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/planned_motion.hpp"
#include "planning/planner_table.hpp"

namespace clearway {

namespace {

using Clock = std::chrono::steady_clock;

/// Does a recorded session again.
int replay_session(const ReplayOptions& options, Console& console) {
  if (!options.planners.empty() || options.seen_within || !options.plan || !options.record.empty())
    throw std::invalid_argument(quote_path(options.recording.string()) +
                                " is a recorded session, which is done again as it was: expected no "
                                "--planner, --seen-within, --no-plan and --record");
  TeachCommand session;
  session.source = options.recording;
  session.setup = options.setup;
  session.resolution = options.resolution;
  session.integration = options.integration;
  session.seed = options.seed;
  session.time_limit = options.time_limit;
  session.overlay = options.overlay;
  session.video = options.video;
  session.out = options.out;
  session.threads = options.threads;
  return run_teach(session, console);
}

/// Each once: it writes a file of its name.
void require_planners(const std::vector<std::string>& names) {
  std::set<std::string> planners;
  for (const std::string& name : names) {
    make_planner(name);
    if (!planners.insert(name).second)
      throw std::invalid_argument("--planner: " + quote(name) + " is given twice, expected it once");
  }
}

/// Refuses, before the work, what cannot be written or is read.
void require_outputs(const ReplayOptions& options, const std::filesystem::path& setup) {
  require_apart({{"--out", options.out},
                 {"--record", options.record},
                 {"--overlay", options.overlay},
                 {"--video-out", options.video}},
                {{"RECORDING", options.recording}, {"--setup", setup}});
  require_not_in({{"--record", options.record}, {"--video-out", options.video}},
                 {"RECORDING", options.recording});
  require_pictures({options.overlay, options.video}, options.recording, options.out);
  require_no_session(options.out);
  require_no_foreign_map("--out", options.out);
}

/// The map, the robot and the plans behind what the fusion saw.
void finish_record(const ReplayReport& report, ReplayRecord& record) {
  record.add_map(report.map);
  for (const ReplayPlan& entry : report.plans) {
    if (!entry.plan.is_proved()) continue;
    const Robot& robot = entry.space->robot();
    record.add_plan(entry.query + "-" + entry.plan.planner, robot, trajectory_of(robot, entry.plan));
  }
  record.finish();
}

/// Why plans have no smooth motion, and why others are none.
void print_shortcomings(const std::vector<ReplayPlan>& plans, std::ostream& out) {
  for (const ReplayPlan& entry : plans) {
    const std::string what = "  " + entry.query + ", " + entry.plan.planner + ": ";
    if (!entry.plan.motion_caveat.empty())
      out << what << "no smooth motion: " << entry.plan.motion_caveat << '\n';
    if (entry.plan.is_proved()) continue;
    out << what
        << (entry.plan.status() == PlanStatus::solved ? entry.plan.validation.first_contact
                                                      : entry.plan.explanation())
        << '\n';
  }
}

void print_report(const ReplayOptions& options, const ReplayReport& report, const std::string& json,
                  Console& console) {
  for (const std::string& warning : report.fusion->warnings) console.warn("warning: " + warning);
  if (report.fusion->damage) console.warn("clearway: " + *report.fusion->damage);
  if (console.json) {
    console.out() << json;
    return;
  }
  print_rows(console.out(), report_figures(report));
  if (!report.plans.empty()) {
    console.out() << '\n';
    print_table(console.out(), plan_table(report));
    print_shortcomings(report.plans, console.out());
  }
  console.out() << "\n  report: " << (options.out / "report.html").string() << '\n';
}

}  // namespace

int run_replay(const ReplayOptions& options, Console& console) {
  if (is_session_folder(options.recording)) return replay_session(options, console);
  require_planners(options.planners);
  const std::filesystem::path setup =
      options.setup.empty() ? options.setup : shipped_file("setups", options.setup);
  require_outputs(options, setup);
  AtomicFolder folder(options.out, is_in_map_folder);  // refuses before the work what cannot be written
  std::filesystem::create_directory(folder.path() / "plans");
  std::optional<ReplayRecord> record;
  if (!options.record.empty()) record.emplace(options.record);

  auto begin = Clock::now();
  Fusion fusion = fuse(options.recording,
                       {setup, options.resolution, options.integration, options.threads,
                        record ? &*record : nullptr, options.camera_seconds},
                       console.bar("fusing"));
  ReplayReport report = report_of(fusion, options.recording);
  report.timings.emplace_back("fuse (all of it)", seconds_since(begin));
  if (fusion.setup_source == "none")
    console.log("note: no setup, neither by --setup nor in the recording: no painting and no plans");

  begin = Clock::now();
  report.map = fusion.map.snapshot();
  std::unique_ptr<QueryRunner> runner;  // reports mistakes of the setup before anything is written
  if (options.plan && fusion.setup.robot && !fusion.setup.queries.empty())
    runner = std::make_unique<QueryRunner>(options, folder.path(), fusion, report.map);
  save_fused_map(report, folder.path());
  report.timings.emplace_back("save map", seconds_since(begin));

  begin = Clock::now();
  if (runner) report.plans = runner->run(console);
  const double motion_s = runner ? runner->motion_seconds() : 0.0;
  report.timings.emplace_back("plan and check", seconds_since(begin) - motion_s);
  report.timings.emplace_back("motion", motion_s);

  const std::string json = save_report(report, folder.path());
  if (record) finish_record(report, *record);
  publish_map_folder(folder, report.map);
  print_report(options, report, json, console);
  if (const PictureOptions pictures{options.overlay, options.video}; pictures.are_asked())
    draw_replay(options.recording, fusion, report.map, report.plans, pictures, console.bar("drawing"));

  if (fusion.damage) return exit_damaged;
  const bool all_solved = std::all_of(report.plans.begin(), report.plans.end(),
                                      [](const ReplayPlan& entry) { return entry.plan.is_proved(); });
  return all_solved ? exit_done : exit_no;
}

}  // namespace clearway
