#include "datasets/pictures/stray_folder.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/poses/pose_columns.hpp"
#include "datasets/sources/finite_number.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Where x, …, qw begin in the lines below such a head; nothing for another one.
std::optional<std::size_t> first_column(const std::vector<std::string>& head) {
  const std::vector<std::string> columns{"x", "y", "z", "qx", "qy", "qz", "qw"};
  const auto found = std::search(head.begin(), head.end(), columns.begin(), columns.end());
  const auto before = static_cast<std::size_t>(found - head.begin());
  const bool is_known = before == 0 || (before == 2 && head[1] == "frame");
  return found == head.end() || !is_known ? std::nullopt : std::optional(before);
}

}  // namespace

std::optional<NumberedPoses> parse_stray_poses(const std::string& text, const std::string& name) {
  constexpr double most_pictures = 1e9;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const auto first = first_column(cells_of(line));
  if (!first) return std::nullopt;
  NumberedPoses numbered{{}, *first > 0};
  for (std::size_t number = 2; std::getline(lines, line); ++number) {
    const auto refuse = [&, number](const std::string& what) {
      throw std::invalid_argument(name + ", line " + std::to_string(number) + ": " + what);
    };
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty()) continue;
    std::vector<double> values;
    for (std::size_t i = *first > 0 ? 1 : 0; i < std::min(cells.size(), *first + 7); ++i)
      if (const auto value = finite_number(cells[i])) values.push_back(*value);
    if (values.size() != (*first > 0 ? 8U : 7U)) refuse("expected numbers as the head names them");
    const double picture = *first > 0 ? values.front() : static_cast<double>(numbered.poses.size());
    if (picture < 0.0 || picture > most_pictures || picture != std::floor(picture))
      refuse("expected the whole number of a picture as its frame");
    const double* const v = values.data() + (*first > 0 ? 1 : 0);
    const Eigen::Quaterniond turn(v[6], v[3], v[4], v[5]);
    if (!(std::abs(turn.norm() - 1.0) < 0.01)) refuse("expected a unit quaternion");
    Eigen::Isometry3d pose(turn.normalized());
    pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
    if (!numbered.poses.emplace(static_cast<std::size_t>(picture), pose).second)
      refuse("picture " + cells[*first - 1] + " has a second pose");
  }
  return numbered;
}

CameraIntrinsics stray_camera(const std::filesystem::path& file, const ImageSize& size) {
  constexpr double width = 1920.0, height = 1440.0, off = 0.1;
  const std::string text = read_input(file, "camera file", 4096);
  std::vector<double> k;
  for (const std::string& cell : cells_of(text))
    if (const auto value = finite_number(cell)) k.push_back(*value);
  const bool is_matrix = k.size() == 9 && k[0] > 0.0 && k[4] > 0.0 && k[1] == 0.0 && k[3] == 0.0 &&
                         k[6] == 0.0 && k[7] == 0.0 && k[8] == 1.0 && std::abs(k[2] / width - 0.5) < off &&
                         std::abs(k[5] / height - 0.5) < off;
  if (!is_matrix || size.width * height != size.height * width)
    throw std::invalid_argument(
        "camera file " + quote_path(file.string()) +
        ": expected the matrix of Stray Scanner's video of 1920 x 1440 pixels, and depth "
        "pictures of its ratio");
  const double by = size.width / width;
  return {size.width, size.height, by * k[0], by * k[4], (k[2] + 0.5) * by - 0.5, (k[5] + 0.5) * by - 0.5,
          {}};
}

}  // namespace clearway
