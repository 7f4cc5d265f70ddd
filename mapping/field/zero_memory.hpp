#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// So many bytes, all 0. Of a large piece the system gives each page when it is first written, so that one
/// of which little is used costs little.
/// @throws std::bad_alloc
std::span<std::uint8_t> zero_memory(std::size_t bytes);

void free_zero_memory(std::span<std::uint8_t> memory);

}  // namespace clearway
