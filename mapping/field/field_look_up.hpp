#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace clearway {

/// What looking up many points needs of a BlockedField; borrowed from it.
struct FieldLookUp {
  const std::atomic<const std::uint16_t*>* tiles = nullptr;  ///< first cell of each (see DistanceTiles)
  int tiles_x = 0, tiles_y = 0;                              ///< tiles along x and y
  int last[3] = {};                  ///< cell of the region on each axis, counted from its first
  double first[3] = {};              ///< cell of the region on each axis, from the map's origin
  double low[3] = {}, high[3] = {};  ///< the region, metres
  double resolution = 0.0, inverse_resolution = 0.0, max_distance = 0.0;
  bool outside_blocked = false;
};

/// Where the points are, an array an axis.
struct FieldPoints {
  const double *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t count = 0;
};

/// Half the square root of each squared distance from 0 to 65535: half voxels squared to voxels.
const double* half_roots();

// What a bound must give up for the rounding of its arithmetic: so much of a voxel, and of the largest
// coordinate.
constexpr double rounding_of_voxel = 1e-9, rounding_of_coordinate = 1e-15;

/// Marks a point that a look-up leaves to BlockedField's functions for one point.
constexpr double left_out = -1.0;

// BlockedField::coarse_clearance and clearance for many points, bit for bit, or `left_out`: for points that
// are beyond the region or not finite, for the last few, where tiles are not known yet, and (clearance) for
// those within 1.5 voxels of an obstacle. They do the same operations in the same order as the functions for
// one point, on doubles side by side. Call them only on a machine that has those registers (see
// best_instruction_set).
void coarse_clearances_avx2(const FieldLookUp& field, const FieldPoints& points, double* out);
void coarse_clearances_avx512(const FieldLookUp& field, const FieldPoints& points, double* out);
void clearances_avx2(const FieldLookUp& field, const FieldPoints& points, double* out);
void clearances_avx512(const FieldLookUp& field, const FieldPoints& points, double* out);

}  // namespace clearway
