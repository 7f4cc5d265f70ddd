#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace clearway::evidence {

/// Picks and places by robot and furniture.
struct PickTally {
  std::uint64_t asked = 0, planned = 0, refused = 0;  ///< refused: planned, but not by the check
  std::vector<double> seconds;                        ///< of CPU that planning took, of those planned
};

/// Their smooth motions, each made and checked. Durations are without the time in which the hand grasps.
struct PickMotions {
  std::uint64_t made = 0, refused = 0;             ///< of all plans; refused: by the check
  std::uint64_t stops = 0;                         ///< waypoints with a stop
  std::map<std::string, std::uint64_t> unblended;  ///< legs that stop at each waypoint, by name
  std::vector<double> ratio;                       ///< duration over that of the path edge by edge
  std::vector<double> cpu;                         ///< s, to make each
};

/// What drawn picks and places came to.
struct PickEvidence {
  std::map<std::string, PickTally> tallies;
  PickMotions motions;
  std::map<std::string, std::uint64_t> failures;  ///< by the first words of the explanation
  std::vector<std::string> broken;
  void add(const PickEvidence& other);
};

/// Pick number `index`: an object on a table or in a shelf, taken by one of three arms and put elsewhere on
/// it. The voxels are those that the solids meet. The arm starts before the furniture with its hand as it
/// grasps. Drawn again until the arm has a free configuration at the object and at its place from which it
/// can lead its tip the straight ways; whether anything is in the way of these, or between them, is not
/// asked.
PickEvidence pick_and_place(std::uint64_t seed, std::uint64_t index);

}  // namespace clearway::evidence
