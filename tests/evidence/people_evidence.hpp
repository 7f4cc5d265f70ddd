#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace clearway::evidence {

/// What teaching sessions of drawn people in drawn kitchens came to.
struct PeopleEvidence {
  std::uint64_t sessions = 0, approved = 0,
                explained = 0;             ///< explained: no approved plan, but a sentence says why
  std::uint64_t walked = 0, set_down = 0;  ///< with a camera that is carried; the probe laid aside in between
  std::map<std::string, std::uint64_t> approved_by_attempt, not_approved_by_reason;
  std::uint64_t mistakes = 0;      ///< strokes that were led through an obstacle
  std::uint64_t mistakes_met = 0;  ///< of these, with painted voxels that sensors call occupied
  std::uint64_t painted = 0,
                painted_inside = 0;  ///< voxels; those deep inside of a true obstacle, unseen from outside
  std::uint64_t seen_points = 0;     ///< of true obstacles that depth images saw; those where paint won
  std::uint64_t painted_over = 0;
  std::map<std::string, std::uint64_t> refused;  ///< events, by action
  std::vector<std::string> broken;               ///< a sentence for each promise that did not hold
  void add(const PeopleEvidence& other);
};

/// Session number `seed`: a kitchen, a person's tremor, strokes, mistakes and choices are drawn, rendered
/// with hands that hide tags and a depth camera that sees them, taught by the program itself, and done again
/// from its record. Who is refused does what the sentence says, in the same session, once, and three
/// persons of ten up to three times. Held:
/// it ends in an approved plan or in a sentence; the record gives the same map, paint and plans byte for
/// byte; no approved plan leads the tool more than 3 mm into a true obstacle.
PeopleEvidence teach_session(std::uint64_t seed);

}  // namespace clearway::evidence
