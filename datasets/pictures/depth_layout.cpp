#include "datasets/pictures/depth_layout.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <set>
#include <sstream>

#include "datasets/cameras/colmap_images.hpp"
#include "datasets/cameras/phone_paths.hpp"
#include "datasets/cameras/picture_matrices.hpp"
#include "datasets/pictures/camera_path.hpp"
#include "datasets/pictures/depth_picture.hpp"
#include "datasets/pictures/name_time.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/picture_poses.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/pictures/polycam_path.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// What is called like a picture; one that is no file is refused when it is read.
std::vector<fs::path> pictures_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_picture_file(entry.path())) files.push_back(entry.path());
  return files;
}

/// 3RScan's PGM, arrays of NumPy, OpenEXR of Record3D and Blender.
std::vector<fs::path> depth_alone_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (is_depth_alone(entry.path())) files.push_back(entry.path());
  return files;
}

/// The pictures whose names begin or end in the first of these words that any does.
std::vector<fs::path> called(const std::vector<fs::path>& pictures,
                             std::initializer_list<const char*> words) {
  std::vector<fs::path> files;
  for (const char* word : words) {
    std::copy_if(pictures.begin(), pictures.end(), std::back_inserter(files),
                 [word](const fs::path& file) { return name_beside(file, word).has_value(); });
    if (!files.empty()) break;
  }
  return files;
}

/// The one file of the folder with this end of its name; empty when there are several or none.
fs::path only_file(const fs::path& folder, const std::string& kind) {
  fs::path found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (extension_of(entry.path()) != kind) continue;
    if (!found.empty()) return {};
    found = entry.path();
  }
  return found;
}

/// The last file of the folder, by name, with this end; empty: there is none.
fs::path last_file(const fs::path& folder, const std::string& kind) {
  fs::path last;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (extension_of(entry.path()) == kind) last = std::max(last, entry.path());
  return last;
}

/// The first of these names that is there.
fs::path first_there(const fs::path& folder, std::initializer_list<const char*> names) {
  std::error_code error;
  for (const char* name : names)
    if (fs::exists(folder / name, error)) return folder / name;
  return {};
}

/// Whether any file is called like the pose of one picture.
bool has_pose_files(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (extension_of(entry.path()) == ".txt" && name_beside(entry.path(), "pose")) return true;
  return false;
}

/// The cameras of TartanAir, of its first version and of its second.
constexpr std::array tartanair_cameras{"left",       "right",      "lcam_front",  "lcam_back",  "lcam_left",
                                       "lcam_right", "lcam_top",   "lcam_bottom", "rcam_front", "rcam_back",
                                       "rcam_left",  "rcam_right", "rcam_top",    "rcam_bottom"};

/// Depth, colour and poses of the first of TartanAir's cameras that has depth.
DepthLayout tartanair_layout(const fs::path& folder) {
  DepthLayout layout;
  for (const std::string camera : tartanair_cameras) {
    const fs::path of_depth = folder / ("depth_" + camera);
    std::vector<fs::path> depth = pictures_in(of_depth);
    if (depth.empty()) depth = depth_alone_in(of_depth);
    if (depth.empty()) continue;
    if (!layout.depth.empty()) {
      layout.unread_depth = of_depth;
      break;
    }
    layout.of_tartanair = true;
    layout.depth = depth;
    layout.colour = pictures_in(folder / ("image_" + camera));
    const std::string poses = "pose_" + camera + ".txt";
    layout.poses = first_there(folder, {poses.c_str()});
  }
  return layout;
}

/// As the folders of data sets are called, or by the pictures' names.
DepthLayout layout_by_names(const fs::path& folder) {
  DepthLayout layout;
  for (const char* name :
       {"depth", "aligned_depth", "depths", "depth_images", "lowres_depth", "arkit_depth", "gt_depth"}) {
    const fs::path of_depth = folder / name;
    std::vector<fs::path> pictures = pictures_in(of_depth);
    const bool has_confidence = std::erase_if(pictures, [](const fs::path& file) {
                                  return name_beside(file, "conf").has_value();
                                }) > 0;
    if (!layout.depth.empty() && !pictures.empty()) layout.unread_depth = of_depth;
    if (layout.depth.empty()) layout.depth = pictures;
    if (layout.depth.empty())
      layout.depth = depth_alone_in(of_depth);
    else if (layout.arrays.empty() && layout.depth.front().parent_path() == of_depth)
      layout.arrays = depth_alone_in(of_depth);
    if (has_confidence && !layout.depth.empty() && layout.depth.front().parent_path() == of_depth)
      layout.confidence = of_depth;  // MobileBrick's
  }
  if (!layout.depth.empty()) {
    const fs::path colour = first_there(folder, {"rgb", "color", "colour", "image", "images", "lowres_wide"});
    if (!colour.empty()) layout.colour = pictures_in(colour);
    layout.pose_folder = first_there(folder, {"pose", "poses"});
    layout.camera_folder = first_there(folder, {"lowres_wide_intrinsics"});
    if (has_matrix_of(folder / "intrinsic", layout.depth.front()))
      layout.camera_folder = folder / "intrinsic";
    if (layout.confidence.empty()) layout.confidence = first_there(folder, {"confidence"});
    layout.tum_table = first_there(
        folder, {"depth.txt", "associations.txt", "association.txt", "associate.txt", "associated.txt"});
    return layout;
  }
  if (layout = tartanair_layout(folder); !layout.depth.empty()) return layout;
  for (const fs::path& flat : {folder, folder / "results", folder / "data", folder / "sequence"}) {
    const std::vector<fs::path> pictures = pictures_in(flat);
    layout.depth = called(pictures, {"depth"});
    if (layout.depth.empty()) layout.depth = called(depth_alone_in(flat), {"depth"});
    if (layout.depth.empty()) continue;
    std::vector<fs::path> others;
    for (const fs::path& picture : pictures)  // frame-000000.depth.png is none of the frames
      if (!name_beside(picture, "depth")) others.push_back(picture);
    layout.colour = called(others, {"color", "colour", "rgb", "image", "frame"});
    layout.pose_folder = first_there(folder, {"pose", "poses"});
    if (layout.pose_folder.empty() && has_pose_files(flat)) layout.pose_folder = flat;
    break;
  }
  return layout;
}

/// A transforms.json of colour pictures alone is none of ours.
std::optional<CameraPath> path_with_depth(const fs::path& transforms, const DepthLayout& layout) {
  const std::string text = read_input(transforms, "poses", largest_poses);
  if (layout.depth.empty() && text.find("\"depth_") == std::string::npos) return std::nullopt;
  return parse_camera_path(text, "poses " + quote_path(transforms.string()));
}

/// The pictures that a path names, where it names depth pictures.
void take_stated_pictures(const CameraPath& path, const fs::path& folder, DepthLayout& layout) {
  std::set<fs::path> depth, colour;
  std::error_code error;
  for (const CameraShot& shot : path.shots) {
    if (shot.depth.empty()) continue;
    depth.insert((folder / shot.depth).lexically_normal());
    const fs::path picture = (folder / shot.picture).lexically_normal();
    if (is_picture_file(picture) && fs::exists(picture, error)) colour.insert(picture);
  }
  if (depth.empty()) return;
  layout.unnamed = static_cast<std::size_t>(
      std::count_if(layout.depth.begin(), layout.depth.end(),
                    [&](const fs::path& picture) { return !depth.contains(picture.lexically_normal()); }));
  layout.depth.assign(depth.begin(), depth.end());
  layout.colour.assign(colour.begin(), colour.end());
}

/// Cameras and scale count whatever the poses are.
void take_bop_scene(const fs::path& scene, const fs::path& stated_poses, DepthLayout& layout) {
  const std::string text = read_input(scene, "poses", largest_poses);
  const bool is_of_bop =
      text.find("\"cam_K\"") != std::string::npos || text.find("\"depth_scale\"") != std::string::npos;
  if (!is_of_bop) return;  // somebody else's file of that name
  const CameraPath path = parse_camera_path(text, "camera file " + quote_path(scene.string()));
  layout.scene_camera = scene;
  if (path.depth_scale) layout.camera.clear();
  if (!stated_poses.empty() || !path.has_poses()) return;
  layout.other_poses = layout.poses.empty() ? layout.pose_folder : layout.poses;
  layout.poses = scene;
}

/// What COLMAP wrote, where its images.txt or images.bin is one.
void take_colmap_model(const fs::path& folder, DepthLayout& layout) {
  for (const char* place : {"images.txt", "images.bin", "sparse/0/images.txt", "sparse/0/images.bin",
                            "sparse/images.txt", "sparse/images.bin"}) {
    const fs::path images = first_there(folder, {place});
    if (images.empty() || !is_colmap_images(read_input(images, "poses", largest_poses))) continue;
    layout.poses = images;
    if (layout.camera.empty())
      layout.camera = first_there(images.parent_path(), {"cameras.txt", "cameras.bin"});
    return;
  }
}

/// BOP's file of the camera of all scenes, which lies above them.
fs::path bop_camera_above(const fs::path& above) {
  const fs::path file = first_there(above, {"camera.json", "../camera.json"});
  if (file.empty()) return {};
  const std::string text = read_input(file, "camera file", largest_poses);
  const bool is_of_bop = text.find("\"depth_scale\"") != std::string::npos &&
                         text.find("\"fx\"") != std::string::npos && text.find("\"cx\"") != std::string::npos;
  return is_of_bop ? file.lexically_normal() : fs::path();
}

}  // namespace

bool is_of_tum(const fs::path& poses) {
  if (poses.empty() || !is_input_there(poses)) return false;
  std::istringstream stream(read_input(poses, "poses", largest_poses));
  std::string line;
  for (int i = 0; i < 3 && std::getline(stream, line); ++i)
    if (line.starts_with("#") && line.find("rgbd_dataset_") != std::string::npos) return true;
  return false;
}

std::vector<fs::path> pictures_of_poses(const DepthLayout& layout) {
  const std::vector<fs::path> depth = in_order_of_names(layout.depth);
  if (!layout.poses_of_colour) return depth;
  const std::vector<fs::path> colour = in_order_of_names(layout.colour);
  constexpr double most_apart = 0.04;  // s
  const auto depth_at = files_by_time(depth), colour_at = files_by_time(colour);
  std::vector<fs::path> paired;
  for (const fs::path& picture : colour) {
    const auto time = time_in_name(picture.stem().string());
    const auto* const near = time ? nearest_file(depth_at, *time, most_apart) : nullptr;
    const auto* const back = near != nullptr ? nearest_file(colour_at, near->first, most_apart) : nullptr;
    paired.push_back(back != nullptr && back->second == picture ? near->second : fs::path());
  }
  return paired;
}

std::optional<DepthLayout> depth_layout(const fs::path& folder, const fs::path& stated_poses) {
  DepthLayout layout = layout_by_names(folder);
  fs::path transforms = first_there(folder, {"transforms.json"});
  if (!stated_poses.empty() && fs::weakly_canonical(stated_poses) != fs::weakly_canonical(transforms))
    transforms.clear();
  const auto path = transforms.empty() ? std::nullopt : path_with_depth(transforms, layout);
  if (path) take_stated_pictures(*path, folder, layout);
  if (layout.depth.empty()) {
    const fs::path keyframes = folder / "keyframes";
    if (!polycam_cameras(keyframes).empty()) return depth_layout(keyframes, stated_poses);
    for (const char* export_folder : {"EXR_RGBD", "iphone"})  // Record3D's, ScanNet++'s
      if (!phone_path_file(folder / export_folder).empty())
        return depth_layout(folder / export_folder, stated_poses);
    return std::nullopt;
  }
  std::error_code error;
  layout.camera = first_there(folder, {"intrinsic/intrinsic_depth.txt",
                                       "intrinsic_depth.txt",
                                       "camera_intrinsic.json",
                                       "intrinsic.json",
                                       "intrinsics.json",
                                       "camera.json",
                                       "camera-intrinsics.txt",
                                       "camera_intrinsics.txt",
                                       "intrinsic.txt",
                                       "intrinsics.txt",
                                       "camera.yaml",
                                       "camera.yml",
                                       "camera.xml",
                                       "camera_info.yaml",
                                       "cam_params.json",
                                       "info.txt",
                                       "_info.txt",
                                       "data/info.txt",
                                       "sequence/_info.txt",
                                       "calibration.txt",
                                       "camera_matrix.csv"});
  layout.extrinsic = first_there(folder, {"intrinsic/extrinsic_depth.txt", "extrinsic_depth.txt"});
  const fs::path above = fs::weakly_canonical(folder, error).parent_path();
  if (layout.camera.empty())
    layout.camera = first_there(above, {"cam_params.json"});  // Replica's, of all its rooms
  if (layout.camera.empty()) layout.camera = bop_camera_above(above);
  if (layout.poses.empty())
    layout.poses = first_there(folder, {"groundtruth.txt", "poses.txt", "trajectory.txt", "trajectory.log",
                                        "traj.txt", "scene/trajectory.log"});
  for (const char* kind : {".log", ".freiburg"})
    if (layout.poses.empty()) layout.poses = only_file(folder, kind);
  if (layout.poses.empty() && layout.pose_folder.empty()) layout.poses = only_file(folder, ".traj");
  if (layout.poses.empty() && layout.pose_folder.empty() && !layout.colour.empty()) {
    layout.poses = last_file(folder / "extrinsics", ".txt");  // SUN3D's, of the colour pictures
    layout.poses_of_colour = !layout.poses.empty();
  }
  if (layout.poses.empty() && layout.pose_folder.empty() && layout.camera.filename() == "camera_matrix.csv")
    layout.poses = first_there(folder, {"odometry.csv"});  // Stray Scanner's
  if (layout.poses.empty() && layout.pose_folder.empty())
    layout.poses = first_there(folder, {"trajectory.json"});
  if (layout.poses.empty() && layout.pose_folder.empty()) layout.poses = polycam_cameras(folder);
  if (layout.poses.empty() && layout.pose_folder.empty()) layout.poses = phone_path_file(folder);
  if (layout.poses.empty() && layout.pose_folder.empty()) take_colmap_model(folder, layout);
  const bool are_arrays_last = layout.poses.empty() && layout.pose_folder.empty();
  (are_arrays_last ? layout.poses : layout.unread_poses) =
      first_there(folder, {"poses.npy", "camera_poses.npy", "trajectory.npy", "traj.npy"});
  if (!path) {
    if (const fs::path scene = first_there(folder, {"scene_camera.json"}); !scene.empty())
      take_bop_scene(scene, stated_poses, layout);
    return layout;
  }
  layout.other_poses = layout.poses.empty() ? layout.pose_folder : layout.poses;
  layout.poses = transforms;
  if (path->has_cameras()) layout.camera.clear();
  return layout;
}

}  // namespace clearway
