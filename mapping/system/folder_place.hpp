#pragma once

#include <filesystem>

namespace clearway {

/// Where a folder that is replaced as a whole stands.
struct FolderPlace {
  std::filesystem::path target;  ///< absolute; what a link points to
  bool exists = false;
};

/// Finds the place, and refuses early what cannot be replaced in one step.
/// @throws std::runtime_error naming `folder` and why not: it is no folder, a mount point, the present folder
///         or above it, or it or its parent cannot be written.
FolderPlace place_of_folder(const std::filesystem::path& folder);

}  // namespace clearway
