#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "mapping/snapshot.hpp"

namespace clearway {

/// Each byte as two hexadecimal digits.
std::string hexadecimal(std::span<const unsigned char> bytes);

/// SHA-256 of the bytes as 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

/// SHA-256 of the map.ot that save_map would write, without writing it.
std::string map_sha256(const Snapshot& map);

/// Of a file's bytes, which are read piece by piece. @throws std::runtime_error when it cannot be read
std::string file_sha256(const std::filesystem::path& file);

}  // namespace clearway
