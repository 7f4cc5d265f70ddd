#pragma once

// Not part of the installed library.

#include <cstddef>
#include <vector>

#include "planning/path/motion_section.hpp"
#include "planning/path/path_torques.hpp"

namespace clearway {

/// A section driven in one way, before it is averaged.
struct DrivenSamples {
  MotionDrive drive;
  PathSamples samples;
  std::size_t window = 1;

  std::size_t periods() const { return samples.positions.size() + window; }
};

/// The samples of a drive, with no window yet. @param torques of the path, for a drive that keeps a share of
/// them
/// @throws std::invalid_argument as time_section
DrivenSamples driven(const SmoothPath& path, const RateLimits& limits, const MotionDrive& drive,
                     double period, const std::vector<StretchTorques>& torques);

/// The least over which acceleration changes by no more than jerk allows. @throws as time_section
std::size_t window_of(const DrivenSamples& made, const RateLimits& limits, double period);

/// Makes the section's motion: the samples averaged.
void take(DrivenSamples made, double period, MotionSection& section);

/// Times the section's path by its drive; where it has none by the one that ends first, which it has then.
/// @throws std::invalid_argument as time_section
void drive_section(MotionSection& section, const RateLimits& limits, double period,
                   const std::vector<StretchTorques>& torques, double torque_share);

}  // namespace clearway
