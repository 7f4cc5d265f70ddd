#include "datasets/cameras/phone_paths.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_phone_file = std::size_t{64} << 20U;  ///< bytes

/// Empty for what cannot be read, which is somebody else's.
std::string text_of(const fs::path& file) try {
  return is_input_there(file) ? read_input(file, "poses", largest_phone_file) : "";
} catch (const std::invalid_argument&) {
  return "";
}

/// Not what is JSON of another kind, or none.
bool is_record3d_file(const fs::path& file) try {
  const std::string text = text_of(file);
  return text.find("\"K\"") != std::string::npos && is_record3d(PathFields::parse(text, "poses"));
} catch (const std::invalid_argument&) {
  return false;
}

Eigen::Isometry3d record3d_pose(const PathFields& field) {
  constexpr char expected[] = "[qx, qy, qz, qw, x, y, z] with a unit quaternion";
  const std::vector<double> v = field.numbers();
  if (v.size() != 7) field.fail(expected);
  const Eigen::Quaterniond turn(v[3], v[0], v[1], v[2]);
  constexpr double most_off = 0.01;
  if (!(std::abs(turn.norm() - 1.0) < most_off)) field.fail(expected);
  Eigen::Isometry3d pose(turn.normalized());
  pose.translation() = Eigen::Vector3d(v[4], v[5], v[6]);
  return pose;
}

CameraIntrinsics record3d_camera(const PathFields& file, const PathFields& field) {
  constexpr char expected[] =
      "[fx, 0, 0, 0, fy, 0, cx, cy, 1], column by column, or [fx, fy, cx, cy], fx and fy > 0";
  std::vector<double> k = field.numbers();
  if (k.size() == 9) {
    if (k[1] != 0.0 || k[2] != 0.0 || k[3] != 0.0 || k[5] != 0.0 || k[8] != 1.0) field.fail(expected);
    k = {k[0], k[4], k[6], k[7]};
  }
  if (k.size() != 4 || !(k[0] > 0.0 && k[1] > 0.0)) field.fail(expected);
  return {file.at("w").side(), file.at("h").side(), k[0], k[1], k[2], k[3], {}};
}

/// The entries of a list of one for each pose; none where the file has no such list, or an empty one.
std::vector<PathFields> of_each(const PathFields& file, const char* key, std::size_t poses) {
  if (!file.has(key)) return {};
  std::vector<PathFields> entries = file.at(key).items();
  if (!entries.empty() && entries.size() != poses) file.at(key).fail("one for each of `poses`, or none");
  return entries;
}

/// Of an iPhone's video.
CameraIntrinsics scannetpp_camera(const PathFields& field) {
  constexpr int width = 1920, height = 1440;
  constexpr double off = 0.1;
  const std::vector<double> k = field.numbers();
  const bool is_matrix = k.size() == 9 && k[0] > 0.0 && k[4] > 0.0 && k[1] == 0.0 && k[3] == 0.0 &&
                         k[6] == 0.0 && k[7] == 0.0 && k[8] == 1.0 && std::abs(k[2] / width - 0.5) < off &&
                         std::abs(k[5] / height - 0.5) < off;
  if (!is_matrix) field.fail("[fx, 0, cx], [0, fy, cy], [0, 0, 1] of pictures of 1920 x 1440 pixels");
  return {width, height, k[0], k[4], k[2], k[5], {}};
}

}  // namespace

fs::path phone_path_file(const fs::path& folder) {
  std::error_code error;
  if (const fs::path file = folder / "metadata.json"; fs::exists(file, error) && is_record3d_file(file))
    return file;
  if (const fs::path file = folder / "pose_intrinsic_imu.json";
      fs::exists(file, error) && text_of(file).find("\"aligned_pose\"") != std::string::npos)
    return file;
  return {};
}

bool is_record3d(const PathFields& file) try {
  for (const char* key : {"poses", "K", "w", "h"})
    if (!file.has(key)) return false;
  const std::vector<PathFields> poses = file.at("poses").items();
  return !poses.empty() && file.at("K").numbers().size() == 9 &&
         std::all_of(poses.begin(), poses.end(),
                     [](const PathFields& pose) { return pose.numbers().size() == 7; });
} catch (const std::invalid_argument&) {
  return false;
}

bool is_scannetpp(const PathFields& file) {
  const std::vector<std::string> keys = file.keys();
  return !keys.empty() && std::all_of(keys.begin(), keys.end(), [&](const std::string& key) {
    return key.starts_with("frame_") && file.at(key.c_str()).has("intrinsic");
  });
}

CameraPath read_record3d(const PathFields& file) {
  CameraPath path;
  path.is_named = true;
  const std::vector<PathFields> poses = file.at("poses").items(),
                                cameras = of_each(file, "perFrameIntrinsicCoeffs", poses.size()),
                                times = of_each(file, "frameTimestamps", poses.size());
  bool has_moved = false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CameraShot& shot = path.shots.emplace_back();
    shot.picture = std::to_string(i);
    Eigen::Isometry3d pose = record3d_pose(poses[i]);
    has_moved |= !pose.isApprox(Eigen::Isometry3d::Identity(), 1e-9);
    // The camera looks along -z there, y is up.
    pose.linear() *= Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
    shot.world_from_camera = pose;
    shot.camera = record3d_camera(file, cameras.empty() ? file.at("K") : cameras[i]);
    if (!times.empty()) shot.time = times[i].time();
  }
  if (poses.size() == 1 || has_moved) {
    path.note = "are Record3D's, in ARKit's world: y of the map points up.";
    return path;
  }
  for (CameraShot& shot : path.shots) shot.world_from_camera.reset();
  path.lack =
      "some that are not the identity: Record3D knows none of the front camera, whose recordings have no "
      "poses";
  return path;
}

CameraPath read_scannetpp(const PathFields& file) {
  CameraPath path;
  path.is_named = path.is_scale_of_integers = true;
  path.depth_scale = 1e-3;
  std::size_t bent = 0;
  for (const std::string& key : file.keys()) {
    const PathFields frame = file.at(key.c_str());
    CameraShot& shot = path.shots.emplace_back();
    shot.picture = key;
    shot.camera = scannetpp_camera(frame.at("intrinsic"));
    if (frame.has("timestamp")) shot.time = frame.at("timestamp").time();
    if (!frame.has("aligned_pose")) continue;
    try {
      const PathFields pose = frame.at("aligned_pose");
      shot.world_from_camera = rigid_of(pose.numbers(), pose, "a rigid transform");
    } catch (const std::invalid_argument&) {
      ++bent;
    }
  }
  path.note = "are the `aligned_pose` of ScanNet++, in the world of the scan's mesh";
  path.note += bent == 0 ? "."
                         : "; " + std::to_string(bent) + " of " + std::to_string(path.shots.size()) +
                               " are no rigid transform, and their pictures are left out.";
  if (!path.has_poses()) path.lack = "`aligned_pose` of four rows of four numbers, a rigid transform";
  return path;
}

}  // namespace clearway
