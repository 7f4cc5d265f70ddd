#pragma once

#include <string>
#include <vector>

#include "apps/compare/compare_results.hpp"

namespace clearway {

/// A name as a file's: letters, digits and ._-= as they are, all else as '_'.
std::string name_as_file(const std::string& name);

/// The same for the labels of planners, told apart where they would be one.
std::vector<std::string> names_as_files(const std::vector<ComparePlanner>& planners);

}  // namespace clearway
