#pragma once

#include <string>
#include <string_view>

namespace clearway {

/// Refuses what is not JSON, and JSON that would take far more memory than its text: nested deeper than 64,
/// more than a million arrays and objects, more than eight million values, or numbers that no double holds;
/// and an object that has a key twice, of which readers take the one or the other. What passes,
/// nlohmann::json::parse takes.
/// @param name what errors call the file: "'plan.json'".
/// @throws std::invalid_argument "<name> is not valid JSON at line 3, column 7: expected a value".
void require_json(std::string_view text, const std::string& name);

}  // namespace clearway
