#pragma once

// Private to check_pick: its maps, found anew by FCL.

#include "planning/check/pick_terms.hpp"

namespace clearway::check {

/// Whether the map has an obstacle in the object's own voxels.
bool is_object_occupied(const PickTerms& terms);

/// The map without the object's own voxels.
Snapshot without_object(const PickTerms& terms);

/// The map without the layer of what the object stands on there.
Snapshot without_layer(const PickTerms& terms, const Snapshot& map, const Eigen::Isometry3d& map_from_object);

/// Whether the map has an obstacle in that layer, or in voxels that only begin below it: the object is put
/// down less than a voxel and the padding above them.
bool is_layer_occupied(const PickTerms& terms, const Snapshot& map, const Eigen::Isometry3d& map_from_object);

}  // namespace clearway::check
