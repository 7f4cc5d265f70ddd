#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace clearway {

/// A mesh file that a robot names, and the factors along its axes.
struct ScaledMesh {
  std::filesystem::path file;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< finite
  std::size_t pieces = 1;  ///< as how many convex bodies at most it counts; more than one: convex_pieces

  bool operator==(const ScaledMesh&) const = default;
};

/// The convex hull of a mesh, or why there is none.
struct MeshHull {
  std::vector<Eigen::Vector3d> corners;  ///< metres, in the file's own axes times the scale
  std::string failure;                   ///< not empty: one sentence that names the file
  bool is_damaged = false;               ///< the file is of the right kind, but its content is not usable
  std::vector<std::vector<Eigen::Vector3d>> further{};  ///< corners of the pieces behind the first
};

/// Reads mesh files (.dae, .obj, .ply, .stl, through assimp; node transforms applied; a COLLADA up direction
/// is ignored, as ROS does; glTF is refused, as programs do not agree on its) and takes the convex hull of
/// each one's vertices. assimp crashes, hangs and eats memory on damaged files: all files of a robot are read
/// in one child process that may take 128 MB and 20 times the files' size, 4 s and a second for every 2 MB,
/// sees no file but these, and sends back hulls only. What a mesh refers to (materials, textures, other
/// files) is not read. Files of more than 100 MB, hulls of more than 20,000 corners, vertices that are not
/// finite or farther than 1 km from the origin are refused. After the first mesh that ends the child the rest
/// of the list stays unread.
std::vector<MeshHull> read_mesh_hulls(const std::vector<ScaledMesh>& meshes);

/// A mesh's triangles, or why there are none.
struct MeshTriangles {
  std::vector<Eigen::Vector3d> corners;  ///< three by three, metres, as hulls are placed and scaled
  std::string failure;                   ///< not empty: one sentence that names the file
};

/// The triangles of one mesh file, read as read_mesh_hulls does; at most 2,000,000.
MeshTriangles read_mesh_triangles(const ScaledMesh& mesh);

/// Folders of packages by name.
using PackageFolders = std::map<std::string, std::filesystem::path>;

/// The file that a URDF mesh name means: `file://` and plain paths relative to `folder`.
/// `package://NAME/rest` and `model://NAME/rest` are rest in the folder that `packages` gives NAME; else what
/// is first found of NAME/rest, or rest in a folder called NAME or whose package.xml says so, in the folders
/// upwards from `folder` (empty: the one in which the program runs);
/// NAME/rest in those of $ROS_PACKAGE_PATH and one below; share/NAME/rest in those of $AMENT_PREFIX_PATH. Of
/// a URI whose file is not there, %20 and the like stand for their characters. Of `package:///rest` and
/// `package://FILE` rest and FILE are in `folder` or the nearest above it that has them.
/// @throws std::invalid_argument when nothing is found.
std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder,
                                const PackageFolders& packages = {});

}  // namespace clearway
