#pragma once

#include "apps/console/commands.hpp"

namespace clearway {

/// Prints what a recording holds: the topics of a ROS bag, the pictures of a folder of depth, else what each
/// sensor took, and when.
/// @throws std::invalid_argument for a file or folder that is none, and for questions that only a map can
/// answer.
int inspect_recording(const InspectOptions& options, Console& console);

}  // namespace clearway
