#include "datasets/cameras/colmap_images.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "datasets/sources/finite_number.hpp"
#include "mapping/system/byte_reader.hpp"

namespace clearway {
namespace {

constexpr std::size_t numbers_of_image = 9;  ///< before its name

/// False for a comment, and for a line that holds nothing.
bool holds_words(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first != std::string::npos && line[first] != '#';
}

/// Of QW QX QY QZ TX TY TZ, camera_from_world; nothing: the quaternion has another length than 1.
std::optional<Eigen::Isometry3d> world_from_camera(const double* numbers) {
  const Eigen::Quaterniond turn(numbers[0], numbers[1], numbers[2], numbers[3]);
  constexpr double most_off = 1e-3;
  if (!(std::abs(turn.norm() - 1.0) <= most_off)) return std::nullopt;
  Eigen::Isometry3d camera_from_world(turn.normalized());
  camera_from_world.translation() = Eigen::Vector3d(numbers[4], numbers[5], numbers[6]);
  return camera_from_world.inverse();
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
  std::string name;
  std::getline(stream >> std::ws, name);
  name.erase(name.find_last_not_of(" \t\r") + 1);
  if (name.empty() || finite_number(name.substr(0, name.find(' ')))) return std::nullopt;
  const auto pose = world_from_camera(&numbers[1]);
  if (!pose) return std::nullopt;
  return ColmapImage{name, *pose};
}

/// `X Y POINT3D_ID` of each; an empty line has none.
bool are_points(const std::string& line) {
  std::istringstream stream(line);
  std::size_t count = 0;
  for (std::string word; stream >> word; ++count)
    if (!finite_number(word)) return false;
  return count % 3 == 0;
}

constexpr std::size_t largest_name = 4096;                         ///< bytes
constexpr std::size_t smallest_image = 4 + 7 * 8 + 4 + 1 + 1 + 8;  ///< with a name of one letter
constexpr std::size_t point_bytes = 8 + 8 + 8;

/// The next image of images.bin. @throws DamagedFile, also when it is none
ColmapImage take_image(ByteReader& reader) {
  reader.get<std::uint32_t>();  // its number
  std::array<double, 7> numbers{};
  for (double& number : numbers) number = reader.get<double>();
  const auto pose = world_from_camera(numbers.data());
  if (!pose) reader.refuse("an image has no unit quaternion");
  reader.get<std::uint32_t>();  // its camera
  ColmapImage image{"", *pose};
  for (char letter = reader.get<char>(); letter != '\0'; letter = reader.get<char>()) {
    if (image.name.size() >= largest_name) reader.refuse("an image has a name of over 4096 letters");
    image.name += letter;
  }
  if (image.name.empty()) reader.refuse("an image has no name");
  reader.take(reader.count(point_bytes) * point_bytes);
  return image;
}

/// Whether the bytes begin with a count and a first image, as those of images.bin do.
bool is_binary(const std::string& bytes) {
  const std::filesystem::path nowhere;
  ByteReader reader(bytes, nowhere);
  try {
    if (reader.count(smallest_image) == 0) return false;
    take_image(reader);
    return true;
  } catch (const DamagedFile&) {
    return false;
  }
}

std::vector<ColmapImage> parse_binary(const std::string& bytes, const std::string& name) {
  const std::filesystem::path nowhere;
  ByteReader reader(bytes, nowhere);
  std::vector<ColmapImage> images;
  std::size_t number = 0;
  try {
    const std::size_t count = reader.count(smallest_image);
    for (; number < count; ++number) images.push_back(take_image(reader));
  } catch (const DamagedFile&) {
    throw std::invalid_argument(name + ", image " + std::to_string(number + 1) +
                                ": expected number, pose, camera, name and points of an image, as COLMAP "
                                "writes them in images.bin");
  }
  if (!reader.at_end())
    throw std::invalid_argument(name + ": expected nothing behind its " + std::to_string(number) + " images");
  return images;
}

}  // namespace

bool is_colmap_images(const std::string& text) {
  if (is_binary(text)) return true;
  if (text.find("IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ") != std::string::npos) return true;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (holds_words(line)) return image_of(line).has_value();
  return false;
}

std::vector<ColmapImage> parse_colmap_images(const std::string& text, const std::string& name) {
  if (is_binary(text)) return parse_binary(text, name);
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
