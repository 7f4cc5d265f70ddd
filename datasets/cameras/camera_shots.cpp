#include "datasets/cameras/camera_shots.hpp"

#include <algorithm>

#include "datasets/cameras/rigid_pose.hpp"

namespace clearway {

bool CameraPath::has_cameras() const {
  return std::all_of(shots.begin(), shots.end(),
                     [](const CameraShot& shot) { return shot.camera.has_value(); });
}

bool CameraPath::has_poses() const {
  return std::any_of(shots.begin(), shots.end(),
                     [](const CameraShot& shot) { return shot.world_from_camera.has_value(); });
}

Eigen::Isometry3d rigid_of(const std::vector<double>& rows, const PathFields& field, const char* expected) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  if (rows.size() != 12 && rows.size() != 16) field.fail(expected);
  for (std::size_t i = 0; i < rows.size(); ++i)
    matrix(static_cast<int>(i) / 4, static_cast<int>(i) % 4) = rows[i];
  const auto pose = rigid_pose(matrix);
  if (!pose) field.fail(expected);
  return *pose;
}

}  // namespace clearway
