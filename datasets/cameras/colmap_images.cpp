#include "datasets/cameras/colmap_images.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "datasets/sources/finite_number.hpp"

namespace clearway {
namespace {

constexpr std::size_t numbers_of_image = 9;  ///< before its name

/// False for a comment, and for a line that holds nothing.
bool holds_words(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first != std::string::npos && line[first] != '#';
}

/// Nothing: the line is not that of an image.
std::optional<ColmapImage> image_of(const std::string& line) {
  std::istringstream stream(line);
  std::array<double, numbers_of_image> numbers{};
  for (double& number : numbers) {
    std::string word;
    stream >> word;
    const auto value = finite_number(word);
    if (!value) return std::nullopt;
    number = *value;
  }
  ColmapImage image;
  std::getline(stream >> std::ws, image.name);
  image.name.erase(image.name.find_last_not_of(" \t\r") + 1);
  if (image.name.empty() || finite_number(image.name.substr(0, image.name.find(' ')))) return std::nullopt;
  const Eigen::Quaterniond turn(numbers[1], numbers[2], numbers[3], numbers[4]);
  constexpr double most_off = 1e-3;
  if (std::abs(turn.norm() - 1.0) > most_off) return std::nullopt;
  Eigen::Isometry3d camera_from_world(turn.normalized());
  camera_from_world.translation() = Eigen::Vector3d(numbers[5], numbers[6], numbers[7]);
  image.world_from_camera = camera_from_world.inverse();
  return image;
}

/// `X Y POINT3D_ID` of each; an empty line has none.
bool are_points(const std::string& line) {
  std::istringstream stream(line);
  std::size_t count = 0;
  for (std::string word; stream >> word; ++count)
    if (!finite_number(word)) return false;
  return count % 3 == 0;
}

}  // namespace

bool is_colmap_images(const std::string& text) {
  if (text.find("IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ") != std::string::npos) return true;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (holds_words(line)) return image_of(line).has_value();
  return false;
}

std::vector<ColmapImage> parse_colmap_images(const std::string& text, const std::string& name) {
  std::vector<ColmapImage> images;
  std::istringstream lines(text);
  std::size_t number = 0;
  const auto refuse = [&](const std::string& expected) {
    throw std::invalid_argument(name + ", line " + std::to_string(number) + ": expected " + expected);
  };
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (!holds_words(line)) continue;
    const auto image = image_of(line);
    if (!image) refuse("'IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME' of COLMAP, with a unit quaternion");
    images.push_back(*image);
    ++number;
    if (std::getline(lines, line) && !are_points(line))
      refuse("the 2D points of the image above, 'X Y POINT3D_ID' each, or an empty line");
  }
  if (images.empty()) throw std::invalid_argument(name + ": expected at least one image of COLMAP");
  return images;
}

}  // namespace clearway
