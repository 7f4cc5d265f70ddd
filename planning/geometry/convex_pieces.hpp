#pragma once

#include <Eigen/Core>
#include <vector>

namespace clearway {

/// Convex hulls that together contain a mesh and all that it encloses, usually far tighter than the hull of
/// the whole: the mesh is cut by planes across its axes, at each step where the hulls lose most volume. Each
/// part of it that is closed (every edge has an even number of triangles) is cut for itself; all that is not
/// closed stays together in one hull, as nothing says what it encloses. Where a plane cuts, the hull of the
/// cut closes both sides, so that what lies inside stays covered by later cuts.
/// @param triangles corners three by three; vertices that are one have equal coordinates
/// @param most hulls, at least 1
/// @returns corners of hulls, the same for the same mesh
std::vector<std::vector<Eigen::Vector3d>> convex_pieces(const std::vector<Eigen::Vector3d>& triangles,
                                                        std::size_t most);

}  // namespace clearway
