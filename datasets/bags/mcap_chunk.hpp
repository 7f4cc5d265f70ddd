#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace clearway {

constexpr std::size_t most_chunk_bytes = std::size_t{1} << 30U;  ///< unpacked

/// The records of a chunk, unpacked. @param compression "", "lz4", "zstd", or "bz2" as in ROS 1 bags
/// @param crc of what comes out, 0: none
/// @throws std::runtime_error a clause that says what is wrong.
std::vector<std::uint8_t> unpack_chunk(std::span<const std::uint8_t> packed, const std::string& compression,
                                       std::uint64_t unpacked_size, std::uint32_t crc);

}  // namespace clearway
