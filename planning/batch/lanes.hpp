#pragma once

// Not part of the installed library.

#include <cstdint>

namespace clearway {

/// So many configurations, or pieces of edges, are looked at side by side.
constexpr int lane_count = 16;
using LaneBits = std::uint16_t;  ///< one a lane

/// A number for each lane.
struct alignas(64) LaneFloats {
  float at[lane_count];
};
struct alignas(64) LaneDoubles {
  double at[lane_count];
};

}  // namespace clearway
