#pragma once

#include <string>

namespace clearway {

/// What an option of a planner means, in the words of the comment beside it in the planner's header
/// (`BeamOptions::width` for the option `width` of `beam`). Empty for planners and options that are not ours.
std::string option_meaning(const std::string& planner, const std::string& option);

}  // namespace clearway
