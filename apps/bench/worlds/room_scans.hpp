#pragma once

#include <vector>

#include "datasets/sources/recording.hpp"
#include "mapping/scans/scan.hpp"

namespace clearway::bench {

/// A recorded cloud as the map takes it.
Scan scan_of(const CloudFrame& frame);

/// A depth image's pixels with a return, as the map takes them.
Scan scan_of(const DepthImage& image);

/// A generated round through FurnishedRoom, with a structured-light camera's noise: the first `used` of its
/// frames, or all.
std::vector<Scan> room_scans(std::size_t frames, std::size_t used);
inline std::vector<Scan> room_scans(std::size_t frames) { return room_scans(frames, frames); }

/// Frames of a camera that moves round a desk with things on it, about 1.4 m from what it sees, 640 x 480
/// pixels less 11 % without return (273,000 points), with a structured-light camera's noise: the first `used`
/// of a round.
std::vector<Scan> desk_scans(std::size_t frames, std::size_t used);

}  // namespace clearway::bench
