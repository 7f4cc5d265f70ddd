#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace clearway {

/// Whether a message of CDR is one as recorders pack each: a Zstandard frame, whose magic number begins no
/// CDR.
bool is_packed_message(std::span<const std::uint8_t> bytes);

/// @throws std::runtime_error a clause, where it is damaged, or larger than 1 GB
void unpack_message(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& out);

}  // namespace clearway
