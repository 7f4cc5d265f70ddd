#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace clearway::evidence {

/// What the tracker made of drawn sessions whose truth it does not know.
struct PoseEvidence {
  std::uint64_t sessions = 0, samples = 0, accepted = 0;
  std::uint64_t outside = 0;  ///< accepted, but the true ball is farther than the bound that was claimed
  std::map<std::string, std::uint64_t> refused;                            ///< by reason
  std::map<std::string, std::uint64_t> accepted_by_tags, outside_by_tags;  ///< "base x probe" tags used
  std::vector<double> ratio;                            ///< error over bound, accepted samples
  std::vector<double> share;                            ///< painted radius over the ball's, accepted samples
  std::uint64_t painted_voxels = 0, voxels_beyond = 0;  ///< painted, though the ball was never there
  std::vector<std::string>
      broken;  ///< a sentence for each session in which samples are outside or a voxel is
  void add(const PoseEvidence& other);
};

/// Session number `seed`, tracked with default options but for `fixed_camera`, painted and compared.
PoseEvidence track_session(std::uint64_t seed, int frames, double severity);

}  // namespace clearway::evidence
