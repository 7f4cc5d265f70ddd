#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/commands.hpp"

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace clearway {

// What the flags of every command are made of (CLI11). `command_line.cpp` puts the commands together; flags
// of a command with many questions have a file of their own.

/// A command, ready to run with the options that its flags filled.
using Command = std::function<int(Console&)>;

/// What an option's text must be; CLI11's own checks let NaN pass and quote limits of 300 digits.
using Check = std::function<std::string(const std::string&)>;

/// A number in [low, high], called `expected` when it is not.
Check number(const std::string& expected, double low, double high);
Check positive();                                   ///< at most 1e9
std::string whole_number(const std::string& text);  ///< at most 2^64 - 1
std::string file_name(const std::string& text);
/// One of these, which completion offers, too.
CLI::Validator one_of(const std::vector<std::string>& values);
/// Those of an option, empty where it takes others; and its type as help has it, without them.
std::vector<std::string> values_of(const CLI::Option& option);
std::string type_of(const CLI::Option& option);
Check file_of_kind(const std::string& ending);  ///< a name that ends in ".mp4", in whatever case

/// A command with the flags that all have: --quiet, --json.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      Console& console);

/// A flag that names a file or folder.
CLI::Option* add_file(CLI::App& command, const std::string& flag, std::filesystem::path& file,
                      const std::string& text, const std::string& type);

/// A flag that may be given several times, each time with one value.
CLI::Option* add_repeatable(CLI::App& command, const std::string& flag, std::vector<std::string>& values,
                            const std::string& text, const std::string& type);
CLI::Option* add_repeatable(CLI::App& command, const std::string& flag,
                            std::vector<std::filesystem::path>& files, const std::string& text,
                            const std::string& type);

/// What a flag's help says of its default.
struct RobotFlagNotes {
  std::string group = {}, fixed = {}, scale = {}, base = {}, policy = {}, padding = {}, seen_within = {};
};

/// The positional SOURCE, or --camera N in its place, and --seconds of it.
void add_source(CLI::App& command, std::filesystem::path& source, double& seconds, const std::string& name,
                const std::string& text);

/// --seed and --time-limit.
void add_planning_flags(CLI::App& command, std::uint64_t& seed, double& time_limit);

/// --seen-within, seconds. @param note of its default
void add_seen_within(CLI::App& command, std::optional<double>& seconds, const std::string& note);

/// --srdf, --group, --fix, --standing, --package, --xacro: what of a robot moves, and where its files are.
void add_group_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes = {});

/// --padding: metres, or none for `auto`. @param note of its default
void add_padding(CLI::App& command, std::optional<double>& padding, const std::string& note);

/// --scale and --base, of a robot in a map.
void add_place_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes = {});

/// --robot, --srdf, --group, --fix, --package, --xacro: which robot, and what of it moves.
void add_model_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes = {});

/// The same and --scale, --base, --policy, --padding, --seen-within, as `plan` and
/// `check` share them.
void add_robot_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes = {});

/// --attach, as `plan` and `check` share it. @param note of its default
void add_attach(CLI::App& command, std::vector<std::filesystem::path>& files, const std::string& note);

/// --pick and --place, as `plan` and `check` share them. @param note of --pick's default
void add_pick(CLI::App& command, std::filesystem::path& file, std::string& place, const std::string& note);

/// --start, --goal, --goal-pose and what goes with it, and --degrees, as `plan` and `check` share them.
/// @param start, goal, goal_pose notes of them
void add_stops(CLI::App& command, QueryChoice& choice, const std::string& start, const std::string& goal,
               const std::string& goal_pose);

/// A map by the name of its argument, and --cloud-resolution of one that is a cloud. Returns the map's.
/// @param note what else it may be
CLI::Option* add_map(CLI::App& command, std::filesystem::path& map, std::optional<double>& resolution,
                     const std::string& name = "--map", const std::string& note = "");

/// --payload and --gravity, as `plan` and `check` share them. @param payload, gravity notes of their defaults
void add_dynamics(CLI::App& command, DynamicsChoice& dynamics, const std::string& payload,
                  const std::string& gravity);

/// --allow-outside, as `plan`, `check` and `gate` share it.
void add_allow_outside(CLI::App& command, std::vector<std::string>& allow_outside);
/// --allow-outside and --strict, as `plan` and `check` share them.
void add_survey_flags(CLI::App& command, SurveyDemands& demands);

Command add_replay(CLI::App& app, Console& console);
Command add_teach(CLI::App& app, Console& console);
Command add_plan(CLI::App& app, Console& console);
Command add_check(CLI::App& app, Console& console);
Command add_inspect(CLI::App& app, Console& console);
Command add_compare(CLI::App& app, Console& console);
Command add_import(CLI::App& app, Console& console);
Command add_gate(CLI::App& app, Console& console);
Command add_track(CLI::App& app, Console& console);
Command add_calibrate(CLI::App& app, Console& console);
Command add_robots(CLI::App& app, Console& console);

}  // namespace clearway
