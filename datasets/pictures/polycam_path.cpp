#include "datasets/pictures/polycam_path.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "datasets/cameras/path_fields.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_camera = 64U << 10U;  ///< bytes of a file

std::vector<fs::path> camera_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (extension_of(entry.path()) == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Not what cannot be read, which is somebody else's.
bool is_polycam_camera(const fs::path& file) try {
  return is_input_there(file) &&
         read_input(file, "camera file", largest_camera).find("\"t_00\"") != std::string::npos;
} catch (const std::invalid_argument&) {
  return false;
}

Eigen::Isometry3d pose_of(const PathFields& file) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      const std::string key = "t_" + std::to_string(row) + std::to_string(column);
      pose.matrix()(row, column) = file.at(key.c_str()).number();
    }
  const Eigen::Matrix3d turn = pose.linear();
  if (!(turn * turn.transpose()).isIdentity(1e-3) || turn.determinant() < 0.0)
    file.at("t_00").fail("t_00 to t_22 to be a rotation, row by row");
  // The camera looks along -z there, y is up.
  pose.linear() = Eigen::Quaterniond(turn).normalized().toRotationMatrix() *
                  Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
  return pose;
}

CameraIntrinsics camera_of(const PathFields& file, const ImageSize& size) {
  const int width = file.at("width").side(), height = file.at("height").side();
  const double across = static_cast<double>(size.width) / width,
               down = static_cast<double>(size.height) / height;
  if (std::abs(across - down) * height > 1.0)
    file.at("width").fail("the ratio of its depth pictures, which are of " + std::to_string(size.width) +
                          " x " + std::to_string(size.height) + " pixels");
  const double fx = file.at("fx").number(), fy = file.at("fy").number();
  if (!(fx > 0.0)) file.at("fx").fail("a number > 0");
  if (!(fy > 0.0)) file.at("fy").fail("a number > 0");
  return {size.width,
          size.height,
          across * fx,
          down * fy,
          (file.at("cx").number() + 0.5) * across - 0.5,
          (file.at("cy").number() + 0.5) * down - 0.5,
          {}};
}

}  // namespace

fs::path polycam_cameras(const fs::path& keyframes) {
  for (const char* name : {"corrected_cameras", "cameras"}) {
    const std::vector<fs::path> files = camera_files(keyframes / name);
    if (!files.empty() && is_polycam_camera(files.front())) return keyframes / name;
  }
  return {};
}

CameraPath polycam_path(const fs::path& cameras, const std::optional<ImageSize>& size) {
  CameraPath path;
  path.is_named = path.is_scale_of_integers = true;
  path.depth_scale = 1e-3;
  for (const fs::path& found : camera_files(cameras)) {
    const PathFields file = PathFields::parse(read_input(found, "camera file", largest_camera),
                                              "camera file " + quote_path(found.string()));
    CameraShot& shot = path.shots.emplace_back();
    shot.picture = found.stem().string();
    shot.world_from_camera = pose_of(file);
    if (size) shot.camera = camera_of(file, *size);
  }
  if (path.shots.empty())
    throw std::invalid_argument("poses " + quote_path(cameras.string()) +
                                ": expected Polycam's files of cameras, one for each picture");
  return path;
}

}  // namespace clearway
