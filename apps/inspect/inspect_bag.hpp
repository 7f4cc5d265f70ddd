#pragma once

#include "apps/console/commands.hpp"

namespace clearway {

/// Prints the topics of a ROS bag. @throws std::invalid_argument for a file that is none, and for questions
/// that only a map can answer.
int inspect_bag(const InspectOptions& options, Console& console);

}  // namespace clearway
