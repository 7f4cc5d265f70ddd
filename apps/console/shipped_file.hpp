#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clearway {

/// Names of those that come with the program, sorted. @param folder below datasets: "setups"
std::vector<std::string> shipped_names(const std::string& folder);

/// The file that a user's word means: a path as it is, or the name of a description that comes with the
/// program, as "quick" for datasets/suites/quick.yaml. A file of that name in the working folder goes first.
/// @param folder "suites", "scenes" or "setups"
/// @throws std::invalid_argument for a word that is neither, naming those that there are.
std::filesystem::path shipped_file(const std::string& folder, const std::filesystem::path& given);

}  // namespace clearway
