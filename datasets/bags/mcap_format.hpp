#pragma once

#include <cstdint>
#include <string_view>

// What reader and writer of MCAP share: https://mcap.dev/spec.

namespace clearway::mcap {

constexpr std::string_view magic("\x89MCAP0\r\n", 8);

enum Opcode : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  statistics = 11,
  summary_offset = 14,
  data_end = 15
};

}  // namespace clearway::mcap
