#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

/// Paint that may lie within or behind what scans hit: of spheres that hold a conflict, the voxels that no
/// scan has looked at. A hand that led the ball through an obstacle by mistake leaves them.
struct SuspectPaint {
  std::size_t voxels = 0;
  std::vector<std::string> strokes;  ///< for each voxel one that painted it; by volume, in their order
};
SuspectPaint suspect_paint(const Snapshot& map);

/// The sentence about them, with what to do; empty where there are none.
std::string suspect_paint_caveat(const Snapshot& map);

}  // namespace clearway
