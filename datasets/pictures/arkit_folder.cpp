#include "datasets/pictures/arkit_folder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "datasets/pictures/name_time.hpp"
#include "datasets/sources/finite_number.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr double most_apart = 1.0;  ///< s; names differ by a rounding, and a file may be missing

/// The numbers of a line; empty where a word is none.
std::vector<double> numbers_of_line(const std::string& line) {
  std::istringstream words(line);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const auto number = finite_number(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

CameraIntrinsics read_pincam(const fs::path& file) {
  const std::vector<double> n = numbers_of_line(read_input(file, "camera file", 4096));
  const auto is_side = [](double side) {
    return side >= 32.0 && side <= 20000.0 && side == static_cast<int>(side);
  };
  if (n.size() != 6 || !is_side(n[0]) || !is_side(n[1]) || n[2] <= 0.0 || n[3] <= 0.0)
    throw std::invalid_argument("camera file " + quote_path(file.string()) +
                                ": expected six numbers, width, height, fx, fy, cx and cy");
  return {static_cast<int>(n[0]), static_cast<int>(n[1]), n[2], n[3], n[4], n[5], {}};
}

}  // namespace

bool is_arkit_poses(const fs::path& file, const std::string& text) {
  return extension_of(file) == ".traj" && numbers_of_line(text.substr(0, text.find('\n'))).size() == 7;
}

std::string tum_of_arkit(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  std::string tum;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::vector<double> n = numbers_of_line(line);
    if (n.size() != 7)
      throw std::invalid_argument(name + ", line " + std::to_string(number) +
                                  ": expected a time, a rotation vector and a translation, seven numbers");
    const Eigen::Vector3d turn(n[1], n[2], n[3]);
    Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
    if (turn.norm() > 0.0)
      camera_from_world.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    camera_from_world.translation() = Eigen::Vector3d(n[4], n[5], n[6]);
    const Eigen::Isometry3d pose = camera_from_world.inverse();
    const Eigen::Quaterniond q(pose.linear());
    for (const double value : {n[0], pose.translation().x(), pose.translation().y(), pose.translation().z(),
                               q.x(), q.y(), q.z(), q.w()})
      tum += to_text(value) + ' ';
    tum.back() = '\n';
  }
  return tum;
}

std::vector<CameraIntrinsics> cameras_of_arkit(const fs::path& folder,
                                               const std::vector<fs::path>& pictures) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (extension_of(entry.path()) == ".pincam") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const auto by_time = files_by_time(files);
  std::vector<CameraIntrinsics> cameras;
  for (const fs::path& picture : pictures) {
    const auto time = time_in_name(picture.stem().string());
    const auto* const nearest = time ? nearest_file(by_time, *time, most_apart) : nullptr;
    if (nearest == nullptr)
      throw std::invalid_argument("depth picture " + quote_path(picture.string()) +
                                  " has no camera: expected a file of its time in " +
                                  quote_path(folder.string()));
    cameras.push_back(read_pincam(nearest->second));
  }
  return cameras;
}

}  // namespace clearway
