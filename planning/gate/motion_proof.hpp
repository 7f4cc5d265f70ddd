#pragma once

// Private to Gate: the straight edges of a chunk's motion and its stops, and what of them is proved.

#include <optional>
#include <vector>

#include "planning/gate/bounds_proof.hpp"
#include "planning/gate/gate.hpp"

namespace clearway {

/// Where a motion has to be proved: free of what blocks it, and within the map's bounds.
struct ProofSpace {
  ConfigurationSpace space;
  BoundsProof bounds;

  bool holds(const Configuration& from, const Configuration& to) const {
    return space.is_edge_free(from, to) && !bounds.leaving(space.robot(), from, to);
  }
};

struct StraightPiece {
  MotionPiece name;
  Configuration from, to;
};

/// All that has to be proved, in the order of the motion.
/// @param standing where the robot may be, each of which has a way to the first configuration; none: there
std::vector<StraightPiece> straight_pieces(const MotionChunk& chunk, const JointLimits& limits,
                                           const std::vector<Configuration>& standing);

/// Where the robot comes to rest that leaves the passed chunk at its configuration `at` and cannot turn into
/// the first edge of `next` there (is_sharp); none: it can, or `at` is 0.
std::optional<Configuration> stop_at_leaving(const MotionChunk& passed, std::size_t at,
                                             const MotionChunk& next, const JointLimits& limits);

/// The first piece that is not proved free; pieces.size() when all are.
std::size_t first_unproved(const ProofSpace& proof, const std::vector<StraightPiece>& pieces);

/// How far along a piece the proof comes, and what is in the way there. With obstruction `none` nothing is,
/// but `part` comes too near to `point` (a blocked voxel's centre; NaN where it is another body).
struct ProofEnd {
  double parameter = 0.0;  ///< 0..1
  Verdict obstruction;
  std::optional<LeavingPart> leaving{};  ///< nothing is in the way, but this part is not proved in the bounds
};
ProofEnd find_proof_end(const ProofSpace& proof, const StraightPiece& piece);

/// The part of a chunk that would be passed, whose `unproved` piece is the first that is not.
std::optional<ProvedPart> proved_part(const ProofSpace& proof, const MotionChunk& chunk,
                                      const JointLimits& limits, const MotionPiece& unproved);

}  // namespace clearway
