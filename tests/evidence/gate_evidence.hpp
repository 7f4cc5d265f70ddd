#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace clearway::evidence {

/// What a Gate did with drawn chunks.
struct GateEvidence {
  std::uint64_t asked = 0, hostile = 0, passed = 0;
  std::map<std::string, std::uint64_t> refused;  ///< by reason
  std::uint64_t checked_edges = 0;  ///< of what was passed, put to the independent check and its survey
  /// Chunks with nothing wrong whose edges the check holds valid with the padding and the way that braking
  /// moves any point added together, and whose survey refuses nothing; of these, those refused, by reason.
  std::uint64_t clear = 0;
  std::map<std::string, std::uint64_t> clear_but_refused;
  std::vector<std::string> broken;  ///< a sentence for each chunk that was passed and must not be
  void add(const GateEvidence& other);
};

constexpr std::uint64_t chunks_of_a_world = 1000;

/// Chunks of drawn world number `world` of a seed, `count` of them, to a gate with drawn options: a robot
/// that wanders, and what a hostile program makes of its chunks (values that are not finite, sizes, times
/// that repeat or go back, jumps, limits, velocities, old maps). What is passed must keep every rule, judged
/// by code of its own, and its edges and stops are put to the independent check and to the survey of where
/// they lead, which must accept them. Every second world ends where its robot reaches.
GateEvidence judge_chunks(std::uint64_t seed, std::uint64_t world, std::uint64_t count);

}  // namespace clearway::evidence
