#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// So many bytes, all 0. Of a large piece the system gives each page when it is first written, so that one
/// of which little is used costs little; of a middling one it may give large pages, which cost fewer faults.
/// @throws std::bad_alloc
std::span<std::uint8_t> zero_memory(std::size_t bytes);

void free_zero_memory(std::span<std::uint8_t> memory);

/// The same for a piece that is all 0 again: some of them wait for whoever next wants as many bytes, who
/// then has no page faults. Safe for many threads. Under a memory sanitizer none waits.
void keep_zero_memory(std::span<std::uint8_t> memory);

constexpr std::size_t kept_zero_bytes = std::size_t{64} << 20U;  ///< that wait, at most

}  // namespace clearway
