#include "datasets/poses/ned_poses.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "datasets/poses/word_lines.hpp"
#include "datasets/sources/finite_number.hpp"

namespace clearway {
namespace {

constexpr std::size_t numbers_of_pose = 7;

Eigen::Isometry3d ned_from_optical() {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return turn;
}

/// Nothing when the words are not seven numbers with a unit quaternion.
std::optional<Eigen::Isometry3d> ned_pose(const std::vector<std::string>& words) {
  std::array<double, numbers_of_pose> v{};
  if (words.size() != v.size()) return std::nullopt;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto number = finite_number(words[i]);
    if (!number) return std::nullopt;
    v[i] = *number;
  }
  const Eigen::Quaterniond turn(v[6], v[3], v[4], v[5]);
  constexpr double most_off = 0.01;
  if (!(std::abs(turn.norm() - 1.0) < most_off)) return std::nullopt;
  Eigen::Isometry3d pose(turn.normalized());
  pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
}

}  // namespace

bool is_ned_poses(const std::filesystem::path& file, const std::string& text) {
  const std::string name = file.filename().string();
  if (!name.starts_with("pose_") || !name.ends_with(".txt")) return false;
  const std::string camera = name.substr(5, name.size() - 9);
  const bool is_of_tartanair =
      camera == "left" || camera == "right" || camera.starts_with("lcam_") || camera.starts_with("rcam_");
  return is_of_tartanair && words_in(text.substr(0, text.find('\n'))).size() == numbers_of_pose;
}

NumberedPoses parse_ned_poses(const std::string& text, const std::string& name) {
  NumberedPoses numbered{{}, true, true};
  for (const WordLine& line : word_lines(text)) {
    const auto pose = ned_pose(line.words);
    if (!pose)
      throw std::invalid_argument(name + ", line " + std::to_string(line.number) +
                                  ": expected 'tx ty tz qx qy qz qw' with a unit quaternion");
    numbered.poses.emplace(numbered.poses.size(), *pose * ned_from_optical());
  }
  return numbered;
}

}  // namespace clearway
