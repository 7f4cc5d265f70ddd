#pragma once

#include <map>
#include <string>
#include <vector>

namespace clearway {

class YamlFields;

// What the queries of a setup and the problems of a suite have in common.

/// All keys with their values as texts.
std::map<std::string, std::string> read_words(const YamlFields& fields);

/// Part or "default" -> painted | known_free | not_occupied. @throws std::invalid_argument for another word.
std::map<std::string, std::string> read_policies(const YamlFields& fields);

/// start(_deg) and goals(_deg), all of one size. @throws std::invalid_argument
void read_legs(const YamlFields& fields, std::vector<double>& start, std::vector<std::vector<double>>& goals);

}  // namespace clearway
