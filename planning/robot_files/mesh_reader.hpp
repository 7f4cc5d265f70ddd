#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace clearway {

/// The corners of the convex hull of a mesh file's vertices, times `scale`, by assimp. `kind` is dae, obj,
/// ply or stl. It may crash, hang or fill the memory: call it in a child process only.
/// @throws std::runtime_error with a reason in our own words, std::bad_alloc.
std::vector<Eigen::Vector3d> hull_of_mesh(const std::filesystem::path& file, const std::string& kind,
                                          const Eigen::Vector3d& scale);

/// The same of at most `pieces` hulls that together contain the mesh (convex_pieces), 15,000 corners in all;
/// one hull of a mesh of more than 200,000 triangles, of one whose splitting takes more memory than there is,
/// and where a vertex of no triangle is a corner of that.
std::vector<std::vector<Eigen::Vector3d>> hulls_of_mesh(const std::filesystem::path& file,
                                                        const std::string& kind, const Eigen::Vector3d& scale,
                                                        std::size_t pieces);

/// The corners of the mesh's triangles, three by three, times `scale`; polygons are cut into triangles. As
/// hull_of_mesh in all else.
std::vector<Eigen::Vector3d> triangles_of_mesh(const std::filesystem::path& file, const std::string& kind,
                                               const Eigen::Vector3d& scale);

/// Whether all points are finite and within 1 km of the origin along each axis.
bool are_sensible(const std::vector<Eigen::Vector3d>& points);

}  // namespace clearway
