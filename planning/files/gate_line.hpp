#pragma once

#include <string>
#include <string_view>

#include "planning/gate/gate.hpp"

namespace clearway {

/// What one line of text asks a Gate:
///   {"id": "pick-7", "times": [0, 0.1], "positions": [[0, 0.5], [0, 0.6]]}
/// `id` is a text or a whole number and may be left out; times in seconds, positions in radians and metres.
/// Other fields, and fields given twice, are refused: what is not understood is not passed.
struct ChunkLine {
  std::string id = "null";  ///< as JSON
  MotionChunk chunk;
  ChunkFault fault;  ///< not_a_chunk or not_finite; none: the chunk was read

  bool is_read() const { return fault.reason == GateReason::none; }
};

/// Reads a line; never throws for what it holds. Of a bad one the id is kept if it came before the fault.
/// Numbers that are NaN, infinite or null are read where JSON allows them, and else make the fault
/// not_finite.
ChunkLine parse_chunk_line(std::string_view line);

/// A verdict as one line of JSON, ASCII, without the line's end:
///   {"line": 3, "id": "pick-7", "passed": false, "reason": "blocked", "sentence": "…", …}
/// @param number of the line, from 1
std::string verdict_line(std::size_t number, const std::string& id, const GateVerdict& verdict);

}  // namespace clearway
