#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace clearway {

class YamlFields;

// What the queries of a setup and the problems of a suite have in common.

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
