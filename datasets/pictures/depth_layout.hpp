#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace clearway {

constexpr std::size_t largest_poses = std::size_t{256} << 20U;  ///< bytes of a file of poses

/// Where a folder keeps its depth pictures, colour pictures and poses.
struct DepthLayout {
  std::vector<std::filesystem::path> depth, colour;  ///< colour may be empty
  std::vector<std::filesystem::path> arrays;         ///< beside pictures in `depth/`: depth of another kind
  std::filesystem::path unread_depth;                ///< another folder of depth pictures; empty: none
  std::filesystem::path poses;         ///< TUM text, numbered poses, a camera's path or COLMAP's; empty: none
  bool poses_of_colour = false;        ///< the poses are those of the colour pictures, in order (SUN3D)
  std::filesystem::path other_poses;   ///< beside transforms.json: which of the two counts is not known
  std::filesystem::path unread_poses;  ///< an array of poses beside others; empty: none
  std::filesystem::path pose_folder;   ///< of a matrix for each depth picture; empty: none
  std::filesystem::path camera;        ///< a file of the depth pictures' camera; empty: none
  std::filesystem::path scene_camera;  ///< BOP's, of cameras and scale, maybe of poses; empty: none
  std::filesystem::path extrinsic;     ///< ScanNet's extrinsic_depth.txt; empty: none
  std::filesystem::path camera_folder;  ///< of a .pincam, or a matrix, for each picture; empty: none
  /// Folder of pictures of 0, 1 and 2, called as the depth's, maybe with `_conf` behind; empty: none.
  std::filesystem::path confidence;
  std::filesystem::path tum_table;  ///< that lists the pictures of `depth/` as TUM does; empty: none
  bool of_tartanair = false;        ///< depth in metres, of what is 1000 m away or farther the sky's
  /// The file that may be a CameraPath with the pictures' cameras.
  const std::filesystem::path& path_file() const { return scene_camera.empty() ? poses : scene_camera; }
  std::size_t unnamed = 0;  ///< depth pictures that transforms.json, which names others, does not name
};

/// Whether the head of a file of poses names one of TUM's recordings (`# file:
/// 'rgbd_dataset_freiburg1_xyz.bag'`). False for one that is not there.
bool is_of_tum(const std::filesystem::path& poses);

/// The layout of a folder as RGB-D data sets are published: `depth/` beside `rgb/`, `color/` or `image/`
/// (TUM, ICL-NUIM, ScanNet, Redwood), or in it or its folders `results/`, `data/` or `sequence/` pictures
/// whose names begin or end in "depth" beside others of "color", "rgb", "image" or "frame" (7-Scenes,
/// Replica); with `groundtruth.txt`, `poses.txt`, `trajectory.txt`, `trajectory.log`, `traj.txt`,
/// `trajectory.json` (Open3D) or the one file
/// `.log` or `.freiburg`, or a folder `pose/` or `poses/`, or NAME.pose.txt; or the pictures that the
/// `transforms.json` of nerfstudio or instant-ngp names, or is of; or as SUN3D's with `extrinsics/`,
/// ARKitScenes' (`lowres_depth/` and a `.traj`) or Stray Scanner's
/// (`odometry.csv` beside `camera_matrix.csv`), Polycam's raw data (`keyframes/` with `corrected_cameras/` or
/// `cameras/`), COLMAP's model (also in `sparse/0/`), TartanAir's (`depth_left/`, `pose_left.txt`),
/// Record3D's export (`metadata.json`, or a folder `EXR_RGBD/` of it), ScanNet++'s of the phone
/// (`pose_intrinsic_imu.json`, or a folder `iphone/` with it), an array of poses (`poses.npy`), or a scene of
/// BOP's (`scene_camera.json`); and
/// `intrinsic/intrinsic_depth.txt` (ScanNet), `camera_intrinsic.json` (Open3D) or another file that is called
/// like a camera's. None when it holds no depth pictures.
/// @param stated_poses the file that a setup names: no other transforms.json counts then; empty: none
/// @throws std::filesystem::filesystem_error when one of the folders cannot be read
/// @throws std::invalid_argument for a transforms.json or scene_camera.json that is none (parse_camera_path)
std::optional<DepthLayout> depth_layout(const std::filesystem::path& folder,
                                        const std::filesystem::path& stated_poses = {});

/// The depth pictures that poses belong to, in order. Of poses of colour pictures (SUN3D) each belongs to the
/// depth picture nearest to its colour picture by the times in their names, if that is also the nearest the
/// other way round, within 40 ms; else to an empty path.
std::vector<std::filesystem::path> pictures_of_poses(const DepthLayout& layout);

}  // namespace clearway
