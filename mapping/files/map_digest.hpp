#pragma once

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

}  // namespace clearway
