#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// So many bytes, all 0. Of a large piece the system gives each page when it is first written, so that one
/// of which little is used costs little; of a middling one it may give large pages, which cost fewer faults.
/// @throws std::bad_alloc
std::span<std::uint8_t> zero_memory(std::size_t bytes);

void free_zero_memory(std::span<std::uint8_t> memory) noexcept;

/// The same for a piece that is all 0 again: the last ones wait for whoever next wants as many bytes, who
/// then has no page faults, or for somebody who gets none otherwise. Safe for many threads and forks.
void keep_zero_memory(std::span<std::uint8_t> memory) noexcept;

/// Whether a piece of this size would wait; under an address sanitizer none does.
bool is_kept(std::size_t bytes) noexcept;

constexpr std::size_t kept_zero_bytes = std::size_t{64} << 20U;  ///< that wait, at most
constexpr std::size_t kept_zero_pieces = 8;                      ///< the same

}  // namespace clearway
