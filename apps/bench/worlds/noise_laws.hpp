#pragma once

#include <string>
#include <vector>

#include "datasets/simulation/room.hpp"

namespace clearway::bench {

/// How a depth camera gets ranges wrong. `safe` integration assumes one law (SafeMargins, after Nguyen et al.
/// 2012); a scene that obeys the same one would flatter it.
struct NoiseLaw {
  std::string name;
  RoomErrors errors;
  bool is_time_of_flight = false;  ///< disturb() adds ranges of its own to the room's
};

/// The assumed law with half, the same and twice its sigma; steps of disparity twice a Kinect's, flying
/// pixels at every edge, no Gaussian; and a time-of-flight camera. All with the same errors of the poses.
std::vector<NoiseLaw> noise_laws(double pose_shift, double pose_turn);

/// Time of flight: sigma = 4 mm + 0.2 % of the range, five times that for 2 % of the pixels, and multipath,
/// which makes smooth patches of the image up to 2.5 % too long.
void disturb(const NoiseLaw& law, std::size_t index, CloudFrame& frame);

}  // namespace clearway::bench
