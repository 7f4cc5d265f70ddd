#pragma once

#include <cstddef>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// A volume that is proved to lie between two numbers, cubic metres.
struct VolumeBounds {
  double lower = 0.0, upper = 0.0;

  double middle() const { return 0.5 * (lower + upper); }
  double half_width() const { return 0.5 * (upper - lower); }
};

/// Volume of a union of spheres, by cubes: those inside one sphere count in full, those outside all spheres
/// not at all, and of the others (cut by the surface) two parallel planes bound the covered part. The cube
/// that is known least is split next, until the bounds are as close as asked.
/// @param relative_width  (upper - lower) / upper to stop at, in (0, 1).
/// @param most_cells  also stops after this many cubes; the bounds hold all the same, only wider.
/// @throws std::invalid_argument for a sphere that is not finite or has no radius > 0, or a width out of
/// range.
VolumeBounds union_volume(const std::vector<Sphere>& spheres, double relative_width = 2e-3,
                          std::size_t most_cells = 2'000'000);

/// An area with an estimate (not a bound) of its error, square metres.
struct AreaEstimate {
  double area = 0.0, error = 0.0;
};

/// Surface area of a union of spheres, cavities included. Each sphere is cut by `circles` circles of
/// latitude; what other spheres cover of a circle is a union of arcs, known exactly, and equal steps of
/// height hold equal areas (Archimedes). The error is the difference to half as many circles.
/// @throws std::invalid_argument for a sphere that is not finite or has no radius > 0, or fewer than 2
/// circles.
AreaEstimate union_area(const std::vector<Sphere>& spheres, int circles = 128);

}  // namespace clearway
