#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/console/commands.hpp"
#include "datasets/descriptions/load_setup.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// What a person may do in a teaching session.
enum class TeachAction {
  paint_on,   ///< the ball paints from here on: a stroke begins
  paint_off,  ///< the stroke ends
  erase_on,   ///< the ball erases from here on
  erase_off,
  object,  ///< the ball marks an object from here on: its voxels, and the body that rides on the hand
  object_off,
  volume,  ///< paint goes into the volume of that label from here on; made when there is none
  robot,   ///< which robot, at what scale and place, under which policies
  branch,  ///< the robot takes its next arm configuration that has the tip where it is
  start,   ///< of the query: where the virtual robot is, or a configuration
  via,     ///< one more goal on the way
  goal,    ///< the last goal; given again, it replaces the one before
  clear,   ///< forget start and goals
  pick,    ///< the virtual robot takes a marked object where it is
  place,   ///< and puts it down where it is
  attach,  ///< a load is in the hand from here on
  detach,
  plan,
  play,
  approve,
  undo,         ///< the last of the above that changed something
  undo_stroke,  ///< the last stroke that painted or erased, whatever was done since
  save,         ///< the map as it is, under maps/
  quit
};
constexpr int teach_actions = 24;

std::string_view to_string(TeachAction action);

/// A load that an event brings with it.
struct TaughtLoad {
  LoadSetup setup;
  std::string json;  ///< as the event has it, a mesh's file with its whole path: reads back bit for bit
};

/// An action at its time; what an action does not use stays empty.
struct TeachEvent {
  double time = 0.0;  ///< s after the first frame
  TeachAction action = TeachAction::quit;
  std::string name{};  ///< of a plan or a saved map; of a volume its label; of a load or object its own
  std::optional<TaughtLoad> load{};           ///< of attach: the load itself, not one of the setup's
  std::vector<std::string> critical_parts{};  ///< of a volume
  RobotChoice robot{};
  bool base_at_ball = false;   ///< of a robot: its base goes where the ball is set down; `robot` has none
  std::vector<double> near{};  ///< of a robot: a configuration on the arm configuration to keep, rad or m
  std::string link{};          ///< of an object: that carries it; empty: the tip's
  double mass = 0.0;           ///< of an object, kg at full size
  std::vector<std::string> touches{};         ///< of an object: links beside the one that carries it
  std::optional<Eigen::Vector3d> approach{};  ///< of a pick, as Pick has it
  std::optional<double> lift{}, contact{};    ///< the same
  std::string q{};  ///< of start, via, goal, pick and place: joint values, comma-separated, or a state's name
  std::string planner = "auto";
  PlannerOptions options{};  ///< of the planner
};

/// One line for each event, each a JSON object with `time`, `action` and the fields of its action
/// (datasets/FORMATS.md). Times do not fall. @throws std::invalid_argument in one sentence naming file, line,
/// field and what was expected; unknown fields and actions with the nearest known one.
std::vector<TeachEvent> load_teach_events(const std::filesystem::path& file);

/// A key of the window and what it does.
struct TeachKey {
  char key = ' ';
  TeachEvent event;  ///< its time is that of the key's stroke
};

/// The same lines with `key`, one visible character, in place of `time`; each key once.
/// @throws as load_teach_events
std::vector<TeachKey> load_teach_keys(const std::filesystem::path& file);

/// The line of an event, without its end; `load_teach_events` reads the same event from it.
std::string to_json_line(const TeachEvent& event);

}  // namespace clearway
