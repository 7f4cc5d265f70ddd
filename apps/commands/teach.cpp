#include <string.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "apps/console/commands.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/quantile.hpp"
#include "apps/console/table.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/inspect/map_folder.hpp"
#include "apps/overlay/replay_pictures.hpp"
#include "apps/pages/report.hpp"
#include "apps/teach/session_folder.hpp"
#include "apps/teach/shown_session.hpp"
#include "apps/teach/taught_folder.hpp"
#include "apps/teach/teach_input.hpp"
#include "apps/teach/teach_keys.hpp"
#include "apps/teach/teach_screen.hpp"
#include "apps/teach/teach_session.hpp"
#include "apps/teach/teach_window.hpp"
#include "datasets/pictures/video.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "mapping/system/file_descriptor.hpp"
#include "mapping/system/interruption.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

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

/// What of a folder this command writes.
bool is_taught(const fs::path& relative) {
  const fs::path part = *relative.begin();
  return is_in_map_folder(relative) || part == "session" || part == "approved" || part == "maps";
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

/// Refuses, before the work, what cannot be written beside --out.
void require_pictures_of(const RecordedSession& recorded, const TeachCommand& command) {
  require_pictures({command.overlay, {}}, recorded.source, command.out);
  if (!command.video.empty()) require_writable(command.video);
  require_apart_from(recorded, command);
}

/// Whether frames come as they are taken, or as if they did: what nobody can repeat.
bool is_live(const TeachInput& input, const TeachScreen* screen) {
  return screen != nullptr || is_camera_name(input.recorded.source);
}

/// What helps with a session that was not finished.
std::string done_again(const fs::path& session) {
  return "`clearway replay " + quote_path(session.string()) + " --out DIR` makes its map and plans";
}

/// What lies beside --out of a live session that was killed, or that goes on.
void require_nothing_unfinished(const TeachCommand& command) {
  const fs::path session = AtomicFolder::partial_of(command.out) / "session";
  std::error_code error;
  if (!is_session_folder(session) || fs::is_empty(session / "events.jsonl", error)) return;
  if (!lock(open_to_read(session.parent_path()), false))
    throw std::invalid_argument("--out: another session is being taught into " +
                                quote_path(session.parent_path().string()) + "; expected another folder");
  throw std::invalid_argument("--out: " + quote_path(session.parent_path().string()) +
                              " holds a session that was not finished; " + done_again(session) +
                              "; expected another folder, or that one moved or removed");
}

/// A session that is led by its events, or by keys of its window, with its film.
class LedSession {
 public:
  /// @param screen null: no window @param folder that its maps and frames go to
  LedSession(const TeachCommand& command, TeachInput& input, TeachScreen* screen, AtomicFolder& folder,
             Console& console)
      : command_(command),
        input_(input),
        screen_(screen),
        folder_(folder),
        session_folder_(folder.path() / "session"),
        console_(console),
        session_(events(), options()),
        shown_(session_, screen, command.video, words_of(input.keys)) {}

  /// Fuses the source, led by the session.
  Fusion fuse();
  /// Keeps what it takes to do the session again. Returns the recording that this is done with.
  fs::path save() const;
  /// From now on the first signal ends the process: the session is published.
  void let_signals_end() { orderly_.reset(); }

  const TeachSession& session() const { return session_; }
  const std::vector<PagePicture>& pictures() const { return shown_.pictures(); }

 private:
  TeachSession::EventSource events();
  TeachOptions options();
  /// The frames of a camera, or of what is shown at its own pace, some of which are left out.
  fs::path frames_file() const;
  RecordedSession recorded() const;
  void keep(const TaughtEvent& reported);
  void begin_live();

  const TeachCommand& command_;
  TeachInput& input_;
  TeachScreen* screen_;
  AtomicFolder& folder_;
  const fs::path session_folder_;
  Console& console_;
  TeachSession session_;
  ShownSession shown_;
  std::optional<GrowingEvents> growing_;  ///< of a live session
  std::atomic<int> signal_ = 0;           ///< that the session ends for; 0: none
  std::optional<OrderlyEnd> orderly_;
};

TeachSession::EventSource LedSession::events() {
  if (!input_.events_file.empty()) return script(std::move(input_.events));
  return [this](double until) {
    return std::isfinite(until) ? events_of_keys(screen_->keys(), input_.keys, session_, until)
                                : std::vector<TeachEvent>{};
  };
}

TeachOptions LedSession::options() {
  return {.seed = input_.recorded.seed,
          .time_limit = input_.recorded.time_limit,
          .waits_for_plans = !input_.events_file.empty(),
          .save = [this](const std::string& name,
                         const Snapshot& map) { save_map(map, folder_.path() / "maps" / name); },
          .note = [this](const std::string& sentence) { console_.log("note: " + sentence); },
          .report = [this](const TaughtEvent& reported) { keep(reported); }};
}

/// What is in the map is work that a person would have to do again.
void LedSession::keep(const TaughtEvent& reported) {
  if (const int signal = signal_.exchange(0); signal != 0)
    console_.warn("clearway: SIG" + std::string(sigabbrev_np(signal)) +
                  " ends the session, which is saved as it is; a second signal leaves it unfinished");
  console_.log(line_of(reported));
  if (!growing_) return;
  growing_->add(session_.events());
  folder_.note_progress("the session so far is",
                        done_again(AtomicFolder::partial_of(command_.out) / "session"));
}

fs::path LedSession::frames_file() const {
  return is_live(input_, screen_) ? session_folder_ / "source" / "frames.rawlog" : fs::path();
}

RecordedSession LedSession::recorded() const {
  RecordedSession recorded = input_.recorded;
  if (const fs::path frames = frames_file(); !frames.empty()) recorded.source = frames;
  return recorded;
}

/// What a live session needs to be done again is there before its first frame.
void LedSession::begin_live() {
  save_session(recorded(), input_.keeper.kept(), session_folder_);
  growing_.emplace(session_folder_);
  orderly_.emplace([this](int signal) {
    signal_ = signal;
    session_.ask_to_end();
  });
}

Fusion LedSession::fuse() {
  const FusionOptions options{.setup_file = input_.setup.source,
                              .resolution = input_.recorded.resolution,
                              .integration = input_.recorded.integration,
                              .threads = command_.threads,
                              .camera_seconds = command_.camera_seconds,
                              .guide = &shown_,
                              .setup = input_.setup.setup,
                              .is_paced = screen_ != nullptr,
                              .frames_file = frames_file()};
  if (is_live(input_, screen_)) begin_live();
  Fusion fusion = clearway::fuse(input_.recorded.source, options, console_.bar("teaching"));
  shown_.finish_film();
  if (screen_) report_times(screen_->times(), console_);
  return fusion;
}

fs::path LedSession::save() const {
  const RecordedSession session = recorded();
  save_session(session, input_.keeper.kept(), session_folder_);
  save_session_events(session_.events(), session_folder_);
  return session.source;
}

/// What became of a session's events and plans.
struct TeachOutcome {
  std::size_t refused = 0;  ///< events
  bool asks_for_plans = false;
  std::size_t approved = 0, voided = 0;  ///< plans
};

TeachOutcome outcome_of(const TeachSession& session, const std::vector<TaughtPlan>& plans,
                        const std::vector<std::string>& broken) {
  TeachOutcome outcome;
  outcome.voided = broken.size();
  for (const TaughtEvent& reported : session.events()) {
    const TeachAction action = reported.event.action;
    outcome.refused += !reported.refusal.empty();
    outcome.asks_for_plans |= action == TeachAction::plan || action == TeachAction::approve;
  }
  for (const TaughtPlan& plan : plans) outcome.approved += plan.is_approved && plan.void_reason.empty();
  return outcome;
}

/// How far a search came when its clock ended it depends on the machine.
void note_timed_plans(const std::vector<TaughtPlan>& plans, double time_limit, Console& console) {
  for (const TaughtPlan& taught : plans)
    if (taught.plan.status() == PlanStatus::timed_out || taught.plan.time_s >= time_limit)
      console.note("plan " + quote(taught.name) + " took all of its time limit of " + short_text(time_limit) +
                   " s: done again, it may report other counts or find another path");
}

/// What the map and the plans leave in doubt.
void warn(const Fusion& fusion, const TeachSession& session, const std::vector<TaughtPlan>& plans,
          double time_limit, Console& console) {
  for (const std::string& warning : fusion.warnings) console.warn("warning: " + warning);
  if (const auto& late = session.late_events(); !late.empty())
    console.note(counted(late.size(), "event") + " (the first at " + significant(late.front(), 6) +
                 " s) came after the last image: no image shows what the probes did then");
  note_timed_plans(plans, time_limit, console);
  if (fusion.damage) console.warn("clearway: " + *fusion.damage);
}

void print_session(const ReplayReport& report, const std::vector<TaughtEvent>& events,
                   const TeachOutcome& outcome, const fs::path& page, std::ostream& out) {
  auto rows = report_figures(report);
  rows.emplace_back("events", std::to_string(events.size()) + ", refused " + std::to_string(outcome.refused));
  rows.emplace_back("plans",
                    std::to_string(report.plans.size()) + ", approved " + std::to_string(outcome.approved) +
                        (outcome.voided > 0 ? ", approved but void " + std::to_string(outcome.voided) : ""));
  print_rows(out, rows);
  for (const TaughtEvent& reported : events)
    if (!reported.refusal.empty()) out << "  " << line_of(reported) << '\n';
  out << "\n  report: " << page.string() << '\n';
}

int exit_of(const Fusion& fusion, const TeachOutcome& outcome, Console& console) {
  if (fusion.damage) return exit_damaged;
  if (outcome.voided > 0) return exit_no;
  if (outcome.approved > 0 || !outcome.asks_for_plans) return exit_done;
  console.note("no plan is approved, which the session asked for: exit status 1");
  return exit_no;
}

/// From the first frame to the folder that is published.
int teach(const TeachCommand& command, const TeachInput& input, AtomicFolder& folder, LedSession& led,
          Console& console) {
  Fusion fusion = led.fuse();
  const fs::path recording = fs::weakly_canonical(led.save()).filename();

  ReplayReport report = report_of(fusion, fs::path("session") / "source" / recording);
  report.map = fusion.map.snapshot();
  save_fused_map(report, folder.path());
  report.pictures = led.pictures();
  std::vector<TaughtPlan> plans(led.session().plans().begin(), led.session().plans().end());
  TaughtFolder taught(folder.path(), report.map, plans);
  report.plans = taught.save();
  fusion.warnings.insert(fusion.warnings.end(), taught.broken().begin(), taught.broken().end());
  report.teaching = teaching_json(led.session(), plans, map_sha256(report.map));
  const std::string json = save_report(report, folder.path());
  publish_map_folder(folder, report.map);
  led.let_signals_end();
  if (!command.overlay.empty())
    draw_replay(input.recorded.source, fusion, report.map, report.plans, {command.overlay, {}},
                console.bar("drawing"));

  warn(fusion, led.session(), plans, input.recorded.time_limit, console);
  const TeachOutcome outcome = outcome_of(led.session(), plans, taught.broken());
  if (console.json)
    console.out() << json;
  else
    print_session(report, led.session().events(), outcome, command.out / "report.html", console.out());
  return exit_of(fusion, outcome, console);
}

}  // namespace

int run_teach(const TeachCommand& command, Console& console) {
  TeachInput input(command);
  require_pictures_of(input.recorded, command);
  const std::unique_ptr<TeachScreen> screen = open_screen(command, console);
  if (!screen && input.events_file.empty())
    throw std::invalid_argument(
        "teach: without a window nobody acts; expected --events FILE (see datasets/FORMATS.md)");
  require_no_session(command.out);
  require_no_foreign_map("--out", command.out);
  const bool is_kept = is_live(input, screen.get());
  if (is_kept) require_nothing_unfinished(command);
  // Refuses before the work what cannot be written.
  AtomicFolder folder(command.out, is_taught, is_kept ? Unpublished::kept : Unpublished::removed);
  for (const char* part : {"plans", "session/source"}) fs::create_directories(folder.path() / part);
  LedSession led(command, input, screen.get(), folder, console);
  try {
    return teach(command, input, folder, led, console);
  } catch (const std::runtime_error& error) {
    const std::string left = folder.unfinished_work();
    if (left.empty()) throw;
    throw std::runtime_error(std::string(error.what()) + "; " + left);
  }
}

}  // namespace clearway
