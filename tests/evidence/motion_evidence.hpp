#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace clearway::evidence {

/// Smooth motions beside those that stop and jerk at waypoints (time_parameterize), along the same paths.
struct MotionEvidence {
  std::uint64_t paths = 0;
  std::uint64_t blended = 0, stops = 0;  ///< waypoints
  std::vector<double> ratio;             ///< duration of the smooth motion over the other's
  std::vector<double> cpu;  ///< s, to make each smooth motion; of waypoints as many as its path has
  std::vector<double> cpu_by_waypoint;                    ///< the same over the number of its waypoints
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;  ///< greatest share of a limit, sampled at 1 kHz
  std::uint64_t samples = 0;
  std::uint64_t refused = 0;        ///< motions that the independent check did not find valid
  std::vector<std::string> broken;  ///< a sentence for each motion that breaks a promise
  void add(const MotionEvidence& other);
};

/// Problems `begin` to `end` - 1 of a seed in drawn worlds, 24 to a world, each solved by the planner whose
/// turn it is among the quick ones; every motion is sampled and checked.
MotionEvidence judge_motions(std::uint64_t seed, std::uint64_t begin, std::uint64_t end);

/// The same for the problems of a suite, `most` of each experiment at most, by the experiments' own planners.
/// Teams are left out.
MotionEvidence judge_motions_of(const std::filesystem::path& suite, std::size_t most);

}  // namespace clearway::evidence
