#include "apps/console/parse.hpp"

#include <charconv>
#include <cmath>
#include <locale>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "datasets/yaml/pose_numbers.hpp"
#include "datasets/yaml/whole_turn.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {

std::vector<double> parse_numbers(const std::string& text, const std::string& what) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    std::string item = text.substr(begin, end - begin);
    item.erase(0, item.find_first_not_of(" \t"));
    item.erase(item.find_last_not_of(" \t") + 1);
    const char* first = item.data() + (item.starts_with('+') ? 1 : 0);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(first, item.data() + item.size(), value);
    if (item.empty() || error != std::errc() || stop != item.data() + item.size() || !std::isfinite(value)) {
      throw std::invalid_argument(what + ": '" + item + "' is not a finite number");
    }
    numbers.push_back(value);
    begin = end + 1;
  }
  return numbers;
}

Eigen::VectorXd parse_configuration(const std::string& text, const std::string& what,
                                    const std::vector<std::string>& joints,
                                    const std::vector<bool>& is_prismatic, bool degrees) {
  const std::vector<double> numbers = parse_numbers(text, what);
  if (numbers.size() != joints.size()) {
    std::string names;
    for (const std::string& joint : joints) names += (names.empty() ? "" : ", ") + joint;
    throw std::invalid_argument(what + ": got " + counted(numbers.size(), "value") + ", expected " +
                                std::to_string(joints.size()) + " (" + names + ")");
  }
  Eigen::VectorXd q(static_cast<Eigen::Index>(numbers.size()));
  for (std::size_t j = 0; j < numbers.size(); ++j) {
    q[static_cast<Eigen::Index>(j)] =
        degrees && !is_prismatic[j] ? numbers[j] * std::numbers::pi / 180.0 : numbers[j];
  }
  return q;
}

Eigen::Isometry3d pose_from_numbers(const std::vector<double>& numbers, const std::string& what) {
  if (numbers.size() != 3 && numbers.size() != 6) {
    throw std::invalid_argument(what + ": got " + std::to_string(numbers.size()) +
                                (numbers.size() == 1 ? " value" : " values") +
                                ", expected x,y,z or x,y,z,roll,pitch,yaw");
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  for (std::size_t i = 3; i < numbers.size(); ++i)
    if (!is_within_turn(numbers[i]))
      throw std::invalid_argument(
          what + ": expected angles in radians, each within a whole turn, got " + short_text(numbers[i]) +
          " (as degrees: " + short_text(numbers[i] * std::numbers::pi / 180.0) + " rad)");
  if (numbers.size() == 6) {
    pose.linear() = (Eigen::AngleAxisd(numbers[5], Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(numbers[4], Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(numbers[3], Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
  }
  return pose;
}

std::vector<double> numbers_from_pose(const Eigen::Isometry3d& pose) {
  std::vector<double> numbers = pose_numbers(pose);
  for (double& number : numbers) number += 0.0;  // no "-0"
  return numbers;
}

std::string to_text(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values)
    text += (text.empty() ? "" : ", ") + significant(value + 0.0, 6);  // no "-0"
  return "(" + text + ")";
}

std::string to_text(const Eigen::Isometry3d& pose) {
  std::vector<double> numbers = numbers_from_pose(pose);
  for (double& number : numbers)
    if (std::abs(number) < 1e-12) number = 0.0;  // of rounding
  return to_text(
      Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size())));
}

std::string significant(double value, int digits) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(digits);
  stream << value;
  return stream.str();
}

}  // namespace clearway
