#pragma once

// Private to Gate: the straight edges of a chunk's motion and its stops, and what of them is proved.

#include <optional>
#include <vector>

#include "planning/gate/gate.hpp"

namespace clearway {

struct StraightPiece {
  MotionPiece name;
  Configuration from, to;
};

/// All that has to be proved, in the order of the motion.
/// @param standing where the robot is; none: at the first configuration
std::vector<StraightPiece> straight_pieces(const MotionChunk& chunk, const JointLimits& limits,
                                           const std::optional<Configuration>& standing);

/// The first piece that is not proved free; pieces.size() when all are.
std::size_t first_unproved(const ConfigurationSpace& space, const std::vector<StraightPiece>& pieces);

/// How far along a piece the proof comes, and what is in the way there. With obstruction `none` nothing is,
/// but `part` comes too near to `point` (a blocked voxel's centre; NaN where it is another body).
struct ProofEnd {
  double parameter = 0.0;  ///< 0..1
  Verdict obstruction;
};
ProofEnd find_proof_end(const ConfigurationSpace& space, const StraightPiece& piece);

/// The part of a chunk that would be passed, whose `unproved` piece is the first that is not.
std::optional<ProvedPart> proved_part(const ConfigurationSpace& space, const MotionChunk& chunk,
                                      const JointLimits& limits, const MotionPiece& unproved);

}  // namespace clearway
