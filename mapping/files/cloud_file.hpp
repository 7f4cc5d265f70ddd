#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/files/cloud_spacing.hpp"
#include "mapping/voxels/eigen_layout.hpp"

namespace clearway {

class FusedTree;

constexpr double usual_cloud_resolution = 0.02;  ///< m

/// True for a name that ends in .pcd, .ply, .bin (velodyne_scan.hpp) or as is_xyz_file says, in small or
/// capital letters.
bool is_cloud_file(const std::filesystem::path& file);

/// Reads the finite points of a .pcd or .ply file with PCL, in a child process: PCL crashes on damaged files;
/// those of a .bin file that can be used, and those of a text (read_xyz_file).
/// @throws DamagedFile when the file is cut off or corrupt, or holds no x, y, z.
std::vector<Eigen::Vector3f> read_cloud(const std::filesystem::path& file);

/// Corners of a triangle.
using CloudFace = std::array<Eigen::Vector3f, 3>;

/// What a file shows of surfaces.
struct CloudSurface {
  std::vector<Eigen::Vector3f> points;  ///< those of the file, then some on its faces
  std::vector<CloudFace> faces = {};    ///< of a .ply that has some, cut up
};

/// The points as read_cloud has them, with others on the faces no farther apart than 0.4 `edge`, metres.
/// @throws std::invalid_argument where these would be more than 50 million; DamagedFile as above, and for a
///         face with a corner that is not finite.
CloudSurface read_surface(const std::filesystem::path& file, double edge);

/// A cloud and the place it was seen from, both in the file's own frame.
struct ViewedCloud {
  std::vector<Eigen::Vector3f> points;  ///< finite ones
  Eigen::Isometry3d file_from_viewpoint = Eigen::Isometry3d::Identity();
  std::size_t left_out = 0;  ///< points that are not finite
};

/// The same with the file's viewpoint (VIEWPOINT of a .pcd, the camera of a .ply; the origin without one).
/// @throws DamagedFile also for a viewpoint that is not a finite place and a unit quaternion.
ViewedCloud read_viewed_cloud(const std::filesystem::path& file);

/// What a comment of the file says of its voxels' edge, metres: export_map writes it.
std::optional<double> stated_edge(const std::filesystem::path& file);

/// Whether a .pcd says that its sensor stood turned: then its points may be in the sensor's frame.
bool has_turned_viewpoint(const std::filesystem::path& file);

/// The voxels that a cloud's points stand for.
struct CloudVoxels {
  double edge = usual_cloud_resolution;  ///< m
  std::vector<ThinnedPart> parts;        ///< each point stands for a cube a quarter wider than they are apart
  std::vector<ThinnedPart> left;         ///< others, too many cubes or strewn: they may have holes
  bool joins_near = false;               ///< what lies between two points is theirs too (cells_between)
};

/// Edge as the file states it, of voxels of which the points are the centres; else `chosen`, else 2 cm, or,
/// of a surface that was thinned to fewer points (thinned_spacing), a quarter more than these are apart, in
/// whole millimetres, so that it has no holes. With the surfaces in it that were thinned further, where
/// nothing is stated; those that it would take more than some 20 million voxels to fill are left, or, where
/// they are most of the cloud, the edge is theirs. Strewn points (strewn_part) are left, too.
/// @param chosen edge that somebody asked for: then nothing is filled but what lies between near points
CloudVoxels voxels_of_cloud(const std::filesystem::path& file, const std::vector<Eigen::Vector3f>& points,
                            std::optional<double> chosen = {});

/// A tree in which each voxel that holds a point, lies between near ones, or meets a face, is occupied, with
/// OctoMap's highest log odds; and what the cubes of thinned parts touch, with those of a single hit; of
/// parts that are left with left_log_odds().
/// @throws std::invalid_argument when the resolution is outside [1e-4, 100] m or too fine for the farthest
/// point.
std::shared_ptr<const FusedTree> tree_of_cloud(const std::vector<Eigen::Vector3f>& points,
                                               const CloudVoxels& voxels, const std::filesystem::path& file,
                                               const std::vector<CloudFace>& faces = {});

/// The next below the highest: they mark what they are of, and are as hard to erase.
float left_log_odds(const FusedTree& tree);

/// Centres of the occupied and conflict voxels at the finest resolution.
/// @throws std::invalid_argument naming `file` when there are more than 100 million.
std::vector<Eigen::Vector3f> occupied_centers(const FusedTree& tree, const std::filesystem::path& file);

/// Binary, x y z; a comment states the edge of the voxels, metres, of which the points are the centres.
std::string format_pcd(const std::vector<Eigen::Vector3f>& points, std::optional<double> edge = {});
/// The same, little endian.
std::string format_ply(const std::vector<Eigen::Vector3f>& points, std::optional<double> edge = {});

}  // namespace clearway
