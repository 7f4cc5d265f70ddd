#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "planning/space/configuration_space.hpp"

namespace clearway::evidence {

/// A path that a planner returned as solved, and where it holds.
struct SolvedPath {
  const ConfigurationSpace* space = nullptr;
  std::vector<Configuration> waypoints;
};

/// What the independent check said of paths.
struct Tally {
  std::uint64_t asked = 0;      ///< problems put, or paths altered
  std::uint64_t solved = 0;     ///< of these, solved, or known to be violated
  std::uint64_t accepted = 0;   ///< of these, held valid by the check
  std::uint64_t undecided = 0;  ///< neither
  std::uint64_t refused = 0;
};

/// Figures by name, and a sentence for each case that breaks the promise.
struct Evidence {
  std::map<std::string, Tally> tallies;
  std::vector<std::string> broken;
  void add(const Evidence& other);
};

constexpr std::uint64_t problems_of_a_world = 60;  ///< three a planner

/// Problems `begin` to `end` - 1 of a seed, each with the planner whose turn it is, sixty to a drawn world:
/// every path that a planner with certified edges returns is put to the independent check, which must accept
/// it. What certifies nothing is counted and breaks no promise.
Evidence plan_problems(std::uint64_t seed, std::uint64_t begin, std::uint64_t end);

/// Valid paths altered (a waypoint moved, left out or exchanged, the base moved, an obstacle put in the way,
/// a joint led past its limit) until `count` of them are known to be violated by a millimetre or more, by
/// brute force: the check must refuse every one. Worlds are drawn from `seed` on.
Evidence alter_paths(std::uint64_t seed, std::uint64_t count);

}  // namespace clearway::evidence
