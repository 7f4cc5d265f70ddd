#include <yaml-cpp/yaml.h>

#include <numbers>

#include "datasets/yaml/whole_turn.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double degree = std::numbers::pi / 180;

}  // namespace

Eigen::Matrix3d rotation_from_rpy(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

std::string YamlFields::degrees_key(const std::string& key) const {
  const bool radians = has(key), degrees = has(key + "_deg");
  if (radians && degrees) fail(key, "given in radians and, as " + key + "_deg, in degrees; expected one");
  return degrees ? key + "_deg" : key;
}

bool YamlFields::has_angles(const std::string& key) const { return has(degrees_key(key)); }

std::vector<double> YamlFields::angles_of(const YAML::Node& node, const std::string& key,
                                          const std::string& given) const {
  std::vector<double> result = numbers_of(node, given, within_reach);
  if (given != key)
    for (double& value : result) value *= degree;
  return result;
}

std::vector<double> YamlFields::angles(const std::string& key) const {
  const std::string given = degrees_key(key);
  return angles_of(required(given), key, given);
}

std::vector<std::vector<double>> YamlFields::lists_of_angles(const std::string& key) const {
  const std::string given = degrees_key(key);
  const YAML::Node node = required(given);
  if (!node.IsSequence()) fail(given, "expected a list of lists of numbers, got " + shown_node(node));
  std::vector<std::vector<double>> result;
  for (const auto& item : node) result.push_back(angles_of(item, key, given));
  return result;
}

std::vector<std::vector<double>> YamlFields::lists_among(const std::string& key) const {
  const std::vector<std::string> words = words_among(key);
  if (words.empty()) return lists_of_angles(key);
  const std::string given = degrees_key(key);
  std::vector<std::vector<double>> result;
  for (const auto& item : required(given))
    result.push_back(words[result.size()].empty() ? angles_of(item, key, given) : std::vector<double>());
  return result;
}

double YamlFields::angle(const std::string& key, double otherwise) const {
  const std::string given = degrees_key(key);
  if (!has(given)) return otherwise;
  const double value = number(given, within_reach);
  if (value < 0.0) fail(given, "expected an angle of 0 or more, got " + short_text(value));
  return value * (given != key ? degree : 1);
}

/// What was given in radians and is more than a turn was meant in degrees.
void YamlFields::require_within_turn(const std::string& key, double given) const {
  if (has(key) && !is_within_turn(given))
    fail(key, "expected angles in radians, each within a whole turn, got " + short_text(given) + "; " + key +
                  "_deg takes degrees, and whole turns may be left out");
}

Eigen::Isometry3d YamlFields::pose(const std::string& key) const {
  const std::string given = degrees_key(key);
  const auto values = numbers(given, within_reach, 6);
  const double unit = given != key ? degree : 1;
  for (std::size_t i = 3; i < 6; ++i) require_within_turn(key, values[i]);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = Eigen::Vector3d(values.data());
  result.linear() = rotation_from_rpy(values[3] * unit, values[4] * unit, values[5] * unit);
  return result;
}

Eigen::Isometry3d YamlFields::pose(const std::string& key, const Eigen::Isometry3d& otherwise) const {
  return has_angles(key) ? pose(key) : otherwise;
}

Eigen::Matrix3d YamlFields::rotation(const std::string& key) const {
  const auto values = angles(key);
  if (values.size() != 3) fail(key, "expected [roll, pitch, yaw]");
  for (const double value : values) require_within_turn(key, value);
  return rotation_from_rpy(values[0], values[1], values[2]);
}

}  // namespace clearway
