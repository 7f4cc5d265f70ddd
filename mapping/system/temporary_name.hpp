#pragma once

#include <filesystem>

namespace clearway {

// Temporary files and folders lie beside what they become and are named `.NAME.clearway-` and 16 random
// hexadecimal digits. Whoever makes one holds a lock (flock) on it: one whose lock is free was left by a
// process that is gone.

/// A name in the folder of `target` that nobody can guess.
std::filesystem::path temporary_name(const std::filesystem::path& target);

/// The same for a folder that makes way for its successor: `.NAME.clearway-aside-` and the digits.
std::filesystem::path moved_aside_name(const std::filesystem::path& target);

/// Whether a file or folder has such a name.
bool is_temporary_name(const std::filesystem::path& path);

/// What a temporary folder on the way to `path` is to become; empty: there is none.
std::filesystem::path lasting_folder(const std::filesystem::path& path);

/// Removes what processes that are gone left in a folder: temporary files and folders of this user that
/// nobody has locked. Where a folder was moved aside and its successor never came, it gets its name back.
void remove_abandoned(const std::filesystem::path& folder);

/// Removes a folder and all below it. Follows no link and stays on its file system. Errors leave the rest.
void remove_tree(const std::filesystem::path& folder);

}  // namespace clearway
