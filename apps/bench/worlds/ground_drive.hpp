#pragma once

#include <cstdint>
#include <vector>

#include "mapping/scans/scan.hpp"

namespace clearway::bench {

/// A lidar on a vehicle. Its rings begin at azimuths of their own, anew in each turn.
struct DrivenLidar {
  const char* name;
  int rings;
  double highest, lowest;  ///< rings, degrees of elevation
  int around;              ///< rays in a ring
  double height;           ///< over the ground, metres
};

/// A drive over uneven ground with kerbs, between boxes and posts. Ranges err by 2 cm, poses by 1 cm and 0.05
/// degrees (sigma), which the scans do not say.
struct GroundDrive {
  std::vector<Scan> scans;
  /// Where rays of other scans truly met the ground and what stands on it; places over the ground, metres.
  std::vector<Eigen::Vector3d> ground, standing;

  /// True places at most 5 m beside the way and so far above the ground, outside of what stands.
  std::vector<Eigen::Vector3d> above(double height, std::size_t count) const;
  double lidar_height = 0.0, length = 0.0;  ///< metres
  std::uint64_t seed = 0;
};

GroundDrive drive(const DrivenLidar& lidar, std::size_t scans, std::uint64_t seed);

}  // namespace clearway::bench
