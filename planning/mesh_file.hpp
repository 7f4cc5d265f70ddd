#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace clearway {

/// All vertices of a mesh file (STL, DAE, OBJ, … through assimp), node transforms applied, in the file's own
/// axes (a COLLADA up direction is ignored, as ROS does) times `scale`, metres.
/// @throws std::invalid_argument naming the file when it is missing, unreadable or has no finite vertex.
std::vector<Eigen::Vector3d> read_mesh_vertices(const std::filesystem::path& file,
                                                const Eigen::Vector3d& scale);

/// The file that a URDF mesh name means: `package://NAME/rest` is searched for upwards from `folder` as
/// NAME/rest and, inside a folder called NAME, as rest; `file://` and plain paths relative to `folder`.
/// @throws std::invalid_argument when nothing is found.
std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder);

}  // namespace clearway
