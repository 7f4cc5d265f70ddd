#pragma once

#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/scan_agreement.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// Looks up voxels that are occupied in `grid` in the map before this scan: all of them, or some evenly
/// spread over them where they are many.
ScanAgreement compare_hits(const FusedTree& before, ScanGrid& grid);

}  // namespace clearway
