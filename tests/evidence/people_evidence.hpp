#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace clearway::evidence {

/// What teaching sessions of drawn people in drawn kitchens came to.
struct PeopleEvidence {
  std::uint64_t sessions = 0, approved = 0, told = 0;  ///< told: no approved plan, but a sentence says why
  std::uint64_t mistakes = 0;                          ///< strokes that were led through an obstacle
  std::uint64_t mistakes_met = 0;  ///< of these, with painted voxels that sensors call occupied
  std::uint64_t painted = 0,
                painted_inside = 0;  ///< voxels; those deep inside of a true obstacle, unseen from outside
  std::map<std::string, std::uint64_t> refused;  ///< events, by action
  std::vector<std::string> broken;               ///< a sentence for each promise that did not hold
  void add(const PeopleEvidence& other);
};

/// Session number `seed`: a kitchen, a person's tremor, strokes, mistakes and choices are drawn, rendered,
/// taught by the program itself and done again from its record. Held: it ends in an approved plan or in a
/// sentence; the record gives the same map, paint and plans byte for byte; no approved plan leads the tool
/// more than 3 mm into a true obstacle.
PeopleEvidence teach_session(std::uint64_t seed);

}  // namespace clearway::evidence
