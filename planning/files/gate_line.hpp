#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planning/gate/gate.hpp"

namespace clearway {

/// What one line of text asks a Gate, to judge a chunk or to go on from elsewhere:
///   {"id": "pick-7", "times": [0, 0.1], "positions": [[0, 0.5], [0, 0.6]]}
///   {"restart": [0, 0.5]}
/// `id` is a text or a whole number and may be left out; times in seconds, positions in radians and metres.
/// `joints` may name the joints in the order of the positions, `leaves_at` is Gate::judge's, and `restart`,
/// without the others of a chunk, holds where the robot stands, or null: anywhere. Other fields, and fields
/// given twice, are refused: what is not understood is not passed.
struct ChunkLine {
  std::string id = "null";  ///< as JSON
  MotionChunk chunk;
  std::optional<std::size_t> leaves_at{};
  std::optional<std::vector<std::string>> joints{};  ///< none: the robot's, in its order
  bool restarts = false;                             ///< or means to, where it has a fault
  std::optional<Configuration> restart{};            ///< of a line that restarts
  ChunkFault fault;                                  ///< not_a_chunk or not_finite; none: the line was read

  bool is_read() const { return fault.reason == GateReason::none; }
};

/// Reads a line; never throws for what it holds. Of a bad one the id is kept if it came before the fault.
/// Numbers that are NaN, infinite or null are read where JSON allows them, and else make the fault
/// not_finite.
ChunkLine parse_chunk_line(std::string_view line);

/// Puts positions, and where the robot restarts, into the order of the robot's joints; a line that names none
/// has it. Names that are not those of its joints, each once, become the line's fault.
void take_order_of(const Robot& robot, ChunkLine& line);

/// The answer to a line that restarts: {"line": 3, "id": "a", "restarted": true}
/// @param sentence why it does not; empty: it does
std::string restart_line(std::size_t number, const std::string& id, const std::string& sentence);

/// A verdict as one line of JSON, ASCII, without the line's end:
///   {"line": 3, "id": "pick-7", "passed": false, "reason": "blocked", "sentence": "…", …}
/// @param number of the line, from 1
std::string verdict_line(std::size_t number, const std::string& id, const GateVerdict& verdict);

}  // namespace clearway
