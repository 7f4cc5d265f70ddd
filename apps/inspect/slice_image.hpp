#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mapping/snapshot.hpp"

namespace clearway {

/// A plane through the map: the axis (0 x, 1 y, 2 z) it is perpendicular to, and where, metres.
struct SlicePlane {
  int axis = 2;
  double value = 0.0;
};

/// Parses "z=0.3". @throws std::invalid_argument with the expected form.
SlicePlane parse_slice(const std::string& text);

/// Draws the voxel states in the plane as a PNG: one square per voxel, axes in metres, a legend with the
/// states' colours and voxel counts in the plane. With `clearance`, also lines of equal clearance under that
/// policy. With `by_age` what was seen free is coloured by how long before the map's newest look it was last
/// seen.
/// @throws std::invalid_argument when the map is empty or the plane misses it (naming its range), or when the
///         map does not know when its voxels were seen;
///         std::runtime_error when the file cannot be written.
void write_slice_image(const Snapshot& map, const SlicePlane& plane, const std::filesystem::path& file,
                       std::optional<Policy> clearance = std::nullopt, bool by_age = false);

}  // namespace clearway
