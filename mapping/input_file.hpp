#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace clearway {

/// All bytes of a regular file. Anything else (a folder, pipe, socket or device, which could keep the program
/// waiting for ever) is refused without waiting for it, and so is a file of more than `largest` bytes.
/// @param what it should be, as errors call it: "map file".
/// @throws std::invalid_argument "<what> '<file>' cannot be read: <why>".
std::string read_input(const std::filesystem::path& file, const std::string& what, std::size_t largest);

/// Refuses what read_input would refuse but for its size, for files that a library opens by their name.
void require_input(const std::filesystem::path& file, const std::string& what);

}  // namespace clearway
