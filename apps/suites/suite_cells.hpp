#pragma once

#include <vector>

#include "datasets/descriptions/scene.hpp"
#include "mapping/snapshot.hpp"
#include "planning/geometry/shape.hpp"

namespace clearway {

/// The body of a solid, about its own origin.
Shape shape_of(const SceneShape& solid);

/// Whether a placed body and the closed cube of a voxel have a point in common; they count as touching when
/// it cannot be proved that they do not, that is nearer to each other than some 1e-9 of their size.
/// @param center of the cube @param edge of the cube, m
bool meets_cube(const Shape& body, const Eigen::Isometry3d& map_from_body, const Eigen::Vector3d& center,
                double edge);

/// Appends the centres of the voxels of this edge that a placed body meets.
void append_cells(const Shape& body, const Eigen::Isometry3d& map_from_body, double edge,
                  std::vector<Eigen::Vector3f>& centers);

/// A map in which a voxel is occupied when a solid meets it, be it deep inside, and unknown otherwise: what
/// no sensor sees, but what solids are. Deterministic.
/// @param resolution m, edge of a voxel, in [1e-4, 100]
/// @throws std::invalid_argument when it is too fine for the farthest solid.
Snapshot map_of_solids(const std::vector<SceneShape>& solids, double resolution);

}  // namespace clearway
