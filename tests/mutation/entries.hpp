#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace clearway::mutation {

/// Blocks of lines "KEY: …", one for each key in their order, with empty lines between; # begins a comment.
/// @throws std::runtime_error naming the file and line that are not so
std::vector<std::map<std::string, std::string>> read_entries(const std::filesystem::path& file,
                                                             const std::vector<std::string>& keys);

}  // namespace clearway::mutation
