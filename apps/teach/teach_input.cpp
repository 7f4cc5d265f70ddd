#include "apps/teach/teach_input.hpp"

#include <stdexcept>

#include "apps/console/flag_names.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/query/setup_robot.hpp"
#include "apps/teach/taught_loads.hpp"
#include "apps/teach/virtual_robot.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/planner_table.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

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

/// Empty: keys in the window.
fs::path file_of_events(const TeachCommand& command) {
  return is_session_folder(command.source) ? command.source / "events.jsonl" : command.events;
}

/// What would leave another planner, robot or load at work than the events say, before the session begins.
/// @param where the event is: "events file 'e.jsonl', at 3 s"
void require_possible(const TeachEvent& event, const Setup& setup, const std::string& where) try {
  if (event.action == TeachAction::plan) make_planner(event.planner, event.options);
  if (event.action == TeachAction::robot)
    VirtualRobot(setup.robot ? with_terms_of(*setup.robot, event.robot) : event.robot, event.near);
  if (event.action == TeachAction::attach) load_of(event, setup);
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument(where + ", " + std::string(to_string(event.action)) + ": " +
                              with_keys(error.what()));
}

/// Keys are for the window, and for what is done there.
std::vector<TeachKey> keys_of_file(const TeachCommand& command, const Setup& setup) {
  if (command.keys.empty()) return {};
  if (!file_of_events(command).empty())
    throw std::invalid_argument(
        "--keys: expected no --events, and no recorded session: its actions are known");
  std::vector<TeachKey> keys = load_teach_keys(command.keys);
  for (const TeachKey& key : keys)
    require_possible(
        key.event, setup,
        "keys file " + quote_path(command.keys.string()) + ", key " + quote(std::string(1, key.key)));
  return keys;
}

}  // namespace

TeachInput::TeachInput(const TeachCommand& command)
    : recorded(session_of(command)),
      events_file(file_of_events(command)),
      keeper(recorded.inputs, {recorded.source, command.source, events_file}, recorded.folder),
      events(events_file.empty() ? std::vector<TeachEvent>{} : load_teach_events(events_file)),
      setup(setup_of(recorded)) {
  for (const TeachEvent& event : events)
    require_possible(
        event, setup.setup,
        "events file " + quote_path(events_file.string()) + ", at " + significant(event.time, 6) + " s");
  keys = keys_of_file(command, setup.setup);
}

}  // namespace clearway
