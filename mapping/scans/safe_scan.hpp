#pragma once

#include <vector>

#include "mapping/scans/safe_margins.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// A neighbourhood of a cell, by steps: each step adds neighbours to what the steps before it reached.
enum class GrowthStep {
  faces,  ///< the 6 cells that share a face
  edges,  ///< the 18 that share a face or an edge
};

/// The neighbourhood that a band of this width (metres, >= 0) is at this resolution. With n = band /
/// resolution, rounded, at most 4: n steps, in turn edges and faces, which reach the cells at most n away
/// along each axis and n + (n + 1) / 2 along all three together. Faces alone for n = 0, nothing for a band of
/// 0.
std::vector<GrowthStep> growth_of(double band, double resolution);

/// The steps that follow those of growth_of and about double their reach, at most 4 voxels in all: what lies
/// outside was seen clearly, by rays that end well behind it and with nothing hit beside them.
std::vector<GrowthStep> clear_growth_of(double band, double resolution);

/// What of a scan's misses counts, beside what it hit.
struct SurfaceMargins {
  std::vector<GrowthStep> spared;   ///< around a hit: nothing is freed
  std::vector<GrowthStep> unclear;  ///< around what is spared: free, but not seen clearly
  bool notes_spared = false;        ///< fills ScanTile::spared
};

/// Takes every cell within the spared neighbourhood of an occupied cell out of `grid`'s free cells: a scan's
/// hit beats its misses around it. Sets `clear` to those free cells that lie beyond the unclear one, too.
/// With `notes_spared` it sets `spared` to all cells within the spared neighbourhood.
/// Occupied cells and their bits stay as they are. Bit-parallel: a few operations for 64 cells.
/// @param threads >= 1; the result does not depend on it.
void spare_surfaces(ScanGrid& grid, const SurfaceMargins& margins, int threads);

/// The same around the occupied cells of `ends`, which are no hits of the scan: takes what lies near them out
/// of `grid`'s free and clear cells, and leaves the spared ones as they are. After spare_surfaces.
void spare_around(const ScanGrid& ends, const SurfaceMargins& margins, ScanGrid& grid, int threads);

}  // namespace clearway
