#pragma once

#include <vector>

#include "datasets/recording.hpp"
#include "mapping/scan.hpp"

namespace clearway::bench {

/// A recorded cloud as the map takes it.
Scan scan_of(const CloudFrame& frame);

/// The frames of a generated round through FurnishedRoom, with a structured-light camera's noise.
std::vector<Scan> room_scans(std::size_t frames);

}  // namespace clearway::bench
