#pragma once

#include <filesystem>
#include <string>

namespace clearway {

/// The URDF that the program `xacro` (of the PATH) makes of a file, without arguments. It runs in a child
/// that may take 1 GB and 20 s and can write no file.
/// @throws std::invalid_argument naming the file when there is no such program, it refuses the file, or its
///         URDF has more than `largest` bytes.
std::string expanded_xacro(const std::filesystem::path& file, std::size_t largest);

}  // namespace clearway
