#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace clearway {

/// Refuses early what `save_file` would refuse late: a folder that is not there or not writable, or a name
/// that something else than a regular file has.
/// @throws std::runtime_error naming `file` and the reason.
void require_writable(const std::filesystem::path& file);

/// Replaces `file` as a whole or not at all: calls `write` with a temporary name in the same folder, syncs
/// what it wrote to disk and renames it. When `write` throws or anything fails, the temporary file is
/// removed, the old file stays as it was and the error is passed on.
/// @throws std::runtime_error naming `file` and the reason.
void save_file(const std::filesystem::path& file,
               const std::function<void(const std::filesystem::path& temporary)>& write);

/// The same for content that is already in memory.
void save_file(const std::filesystem::path& file, std::string_view content);

}  // namespace clearway
