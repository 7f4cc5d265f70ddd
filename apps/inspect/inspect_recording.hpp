#pragma once

#include "apps/console/commands.hpp"

namespace clearway {

/// Whether a folder holds pictures or clouds and is no map's.
bool is_folder_of_frames(const std::filesystem::path& folder);

/// Prints what a recording holds: the topics of a ROS bag, the pictures of a folder of depth, else what each
/// sensor took, and when.
/// @throws std::invalid_argument for a file that is none, and for questions that only a map can answer.
int inspect_recording(const InspectOptions& options, Console& console);

}  // namespace clearway
