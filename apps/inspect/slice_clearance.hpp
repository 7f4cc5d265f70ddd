#pragma once

#include "apps/inspect/picture.hpp"
#include "apps/inspect/slice_canvas.hpp"
#include "apps/inspect/slice_image.hpp"

namespace clearway {

/// Draws lines of equal clearance into a slice: where the bound that planners use (BlockedSpace::clearance
/// under `policy`, all painted volumes), looked up in the middle of voxels and linear between them, is a
/// whole multiple of the returned step, metres. Every fourth line is thicker and labelled in millimetres,
/// where there is room; what is blocked has none.
double draw_clearance(Picture& image, const SliceCanvas& canvas, const Snapshot& map, const SlicePlane& plane,
                      Policy policy);

}  // namespace clearway
