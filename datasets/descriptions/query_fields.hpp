#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace clearway {

class YamlFields;

// What the queries of a setup and the problems of a suite have in common.

/// What of a robot moves, and where its files are, as flags of a command state it.
struct RobotTermsSetup {
  std::filesystem::path srdf{};           ///< beside the file; empty: the robot's own
  std::string group{};                    ///< planning group of the SRDF; empty: the robot's own
  std::map<std::string, double> fixed{};  ///< joints that stand still, rad or m at full size
  std::map<std::string, std::filesystem::path> packages{};  ///< folders of packages of meshes
  std::map<std::string, std::string> xacro{};               ///< arguments of the robot's .xacro
};

/// The keys srdf, group, fixed, packages and xacro. @param folder of the file that has them
/// @throws std::invalid_argument
RobotTermsSetup read_robot_terms(const YamlFields& fields, const std::filesystem::path& folder);

/// Where a way begins and ends: numbers, or the name of a state of the robot's SRDF.
struct WaySetup {
  std::vector<double> start;
  std::string start_state;  ///< empty: `start` has the numbers
  std::vector<std::vector<double>> goals;
  std::vector<std::string> goal_states;  ///< one for each goal, the same
};

/// The key start (or start_deg). @throws std::invalid_argument
void read_start(const YamlFields& fields, WaySetup& way);

/// The key goals (or goals_deg). @throws std::invalid_argument
void read_goals(const YamlFields& fields, WaySetup& way);

/// A planner's options: all keys with their values as texts. A list of numbers is the text "0.1, 0.2".
/// @throws std::invalid_argument
std::map<std::string, std::string> read_options(const YamlFields& fields);

/// Part or "default" -> painted | known_free | not_occupied. @throws std::invalid_argument for another word.
std::map<std::string, std::string> read_policies(const YamlFields& fields);

/// A name as a file's or folder's: letters, digits and ._-= as they are, all else as '_', and one more before
/// a '.' at the beginning.
std::string name_as_file(const std::string& name);

/// Notes `name` as taken, or fails at the key that gave it, where another has it as a file.
/// @throws std::invalid_argument
void take_name(std::set<std::string>& taken, const std::string& name, const YamlFields& fields,
               const std::string& key);

/// padding: a length from 0 to 100 m; none for `auto`, or where the key is left out: the robot's position
/// accuracy.
/// @throws std::invalid_argument
std::optional<double> read_padding(const YamlFields& fields);

}  // namespace clearway
