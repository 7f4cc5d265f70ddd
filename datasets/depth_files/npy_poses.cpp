#include "datasets/depth_files/npy_poses.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "datasets/cameras/rigid_pose.hpp"
#include "datasets/depth_files/npy_file.hpp"
#include "datasets/poses/word_lines.hpp"
#include "datasets/sources/clock_seconds.hpp"
#include "datasets/sources/finite_number.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_numbers = 16U << 20U;  ///< of poses: a million of them, 128 MB
constexpr std::size_t largest_times = 64U << 20U;

bool is_real_type(const std::string& type) { return type == "f4" || type == "f8"; }

NpyNumbers numbers_of_array(const std::string& bytes, const std::string& name) {
  try {
    return decode_npy_numbers(bytes, most_numbers);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(name + ": " + error.what());
  }
}

/// The pose of the 12 or 16 numbers that begin there, rows of a matrix; empty: they are not finite.
std::optional<Eigen::Isometry3d> pose_of_rows(const double* numbers, std::size_t count,
                                              const std::string& name) {
  if (!std::all_of(numbers, numbers + count, [](double number) { return std::isfinite(number); }))
    return std::nullopt;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (std::size_t i = 0; i < count; ++i)
    matrix(static_cast<int>(i) / 4, static_cast<int>(i) % 4) = numbers[i];
  const auto pose = rigid_pose(matrix);
  if (!pose)
    throw std::invalid_argument(name +
                                " is no rigid transform: expected world_from_camera row by row, a rotation "
                                "and a place, and 0 0 0 1 below where it has four rows");
  return pose;
}

/// How many numbers a matrix has, and of how many axes its own shape is: 0 where it is none.
std::pair<std::size_t, std::size_t> matrix_in(const std::vector<std::int64_t>& shape) {
  const std::size_t axes = shape.size();
  if (axes >= 2 && shape[axes - 1] == 4 && (shape[axes - 2] == 4 || shape[axes - 2] == 3))
    return {static_cast<std::size_t>(4 * shape[axes - 2]), 2};
  if (axes == 2 && (shape[1] == 16 || shape[1] == 12)) return {static_cast<std::size_t>(shape[1]), 1};
  return {0, 0};
}

/// @param count of the poses
std::vector<double> times_in(const fs::path& file, const fs::path& poses, std::size_t count) {
  const std::string name = "times " + quote_path(file.string());
  const std::string content = read_input(file, "times", largest_times);
  std::vector<double> times;
  if (is_npy(content)) {
    const NpyNumbers array = numbers_of_array(content, name);
    constexpr double most_of_single = 1e5;  // s, to a hundredth
    const bool is_coarse =
        array.type == "f4" && std::any_of(array.values.begin(), array.values.end(),
                                          [](double time) { return std::abs(time) > most_of_single; });
    if (is_coarse)
      throw std::invalid_argument(name +
                                  ": it has times of 32 bits beyond 100,000, which are too coarse for "
                                  "a clock's: expected numbers of 64 bits");
    if (array.shape.size() != 1 && !(array.shape.size() == 2 && array.shape[1] == 1))
      throw std::invalid_argument(name + ": it is an array of " + array.shape_text +
                                  " entries, expected a time for each pose");
    times = array.values;
  } else {
    for (const WordLine& line : word_lines(content)) {
      const auto time = line.words.size() == 1 ? finite_number(line.words.front()) : std::nullopt;
      if (!time)
        throw std::invalid_argument(name + ", line " + std::to_string(line.number) +
                                    ": expected one number, the time of a pose");
      times.push_back(*time);
    }
  }
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i]) || (i > 0 && times[i] <= times[i - 1]))
      throw std::invalid_argument(name + ": its times do not rise, expected that of each pose in order");
  if (times.size() != count)
    throw std::invalid_argument(name + ": it has " + counted(times.size(), "time") + " for " +
                                std::to_string(count) + " poses of " + quote_path(poses.string()) +
                                ", expected one for each");
  make_seconds(times);
  return times;
}

}  // namespace

NumberedPoses parse_npy_poses(const std::string& bytes, const std::string& name) {
  const NpyNumbers array = numbers_of_array(bytes, name);
  const auto [size, axes] = matrix_in(array.shape);
  if (size == 0 || axes + 1 < array.shape.size())
    throw std::invalid_argument(name + ": it is an array of " + array.shape_text +
                                " entries, expected N x 4 x 4, N x 3 x 4, N x 16 or N x 12 for N poses");
  if (!is_real_type(array.type))
    throw std::invalid_argument(name + ": its numbers are of the type " + quote(array.type) +
                                ", expected real ones of 32 or 64 bits");
  NumberedPoses numbered;
  for (std::size_t i = 0; i < array.values.size() / size; ++i)
    numbered.poses.emplace(
        i, pose_of_rows(&array.values[i * size], size, name + ", matrix " + std::to_string(i)));
  if (numbered.poses.empty()) throw std::invalid_argument(name + ": expected at least one pose");
  return numbered;
}

std::optional<Eigen::Isometry3d> parse_npy_pose(const std::string& bytes, const std::string& name) {
  NumberedPoses numbered = parse_npy_poses(bytes, name);
  if (numbered.poses.size() != 1)
    throw std::invalid_argument(name + ": it has " + std::to_string(numbered.poses.size()) +
                                " poses, expected one, of its picture");
  return numbered.poses.begin()->second;
}

std::vector<double> times_of_npy_poses(const fs::path& poses, std::size_t count,
                                       std::vector<std::string>& notes) {
  const std::string stem = poses.stem().string();
  std::error_code error;
  for (const std::string& name :
       {stem + "_times", stem + "_timestamps", std::string("times"), std::string("timestamps")})
    for (const char* end : {".npy", ".txt"}) {
      const fs::path file = poses.parent_path() / (name + end);
      if (!fs::exists(file, error)) continue;
      try {
        return times_in(file, poses, count);
      } catch (const std::invalid_argument& refusal) {
        if (name.starts_with(stem + "_")) throw;
        notes.push_back(std::string(refusal.what()) + "; they are not used");
      }
    }
  return {};
}

}  // namespace clearway
