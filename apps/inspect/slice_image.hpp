#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/inspect/slice_states.hpp"

namespace clearway {

/// What a slice shows beside the states.
struct SliceLook {
  std::string name{};                 ///< of the map, in the title
  std::optional<Policy> clearance{};  ///< lines of equal clearance under this policy; needs a map in memory
  bool shows_difference = false;      ///< of MapLeaves::difference: the legend says what its states mean
  bool by_age = false;  ///< what was seen free is coloured by how long before the newest look that was
};

/// Parses the plane of --slice. @throws std::invalid_argument with the expected form.
SlicePlane parse_slice(const std::string& text);

/// Draws the voxel states in the plane as a PNG: one square per voxel, axes in metres, a legend with the
/// states' colours and voxel counts in the plane. Planes of more than 1,400 voxels are drawn smaller; of the
/// voxels that share a pixel the one that blocks most is seen. Returns beyond_text.
/// @throws std::invalid_argument when the map is empty or the plane misses it (naming its range), or when the
///         map does not know when its voxels were seen;
///         std::runtime_error when the file cannot be written.
std::string write_slice_image(const MapLeaves& map, const SlicePlane& plane,
                              const std::filesystem::path& file, const SliceLook& look = {});

}  // namespace clearway
