#include "datasets/poses/numbered_poses.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "datasets/cameras/lower_case.hpp"
#include "datasets/cameras/rigid_pose.hpp"
#include "datasets/poses/word_lines.hpp"
#include "datasets/sources/finite_number.hpp"

namespace clearway {
namespace {

constexpr char expected_matrix[] =
    "expected four rows of four numbers, or the first three of them, a rigid transform";

/// True for "nan", "-inf" and "Infinity".
bool is_unknown(const std::string& word) {
  const std::string text = lower_case(word);
  return text.find("inf") != std::string::npos || text.find("nan") != std::string::npos;
}

/// The pose of 12 or 16 words, rows of its matrix; empty when they say that it is not known.
/// @throws std::invalid_argument without a name when they are no rigid transform
std::optional<Eigen::Isometry3d> pose_of(const std::vector<std::string>& words) {
  if (std::any_of(words.begin(), words.end(), is_unknown)) return std::nullopt;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  bool whole = words.size() == 12 || words.size() == 16;
  for (std::size_t i = 0; whole && i < words.size(); ++i) {
    const auto number = finite_number(words[i].starts_with('+') ? words[i].substr(1) : words[i]);
    whole = number.has_value();
    if (whole) matrix(static_cast<int>(i) / 4, static_cast<int>(i) % 4) = *number;
  }
  const auto pose = whole ? rigid_pose(matrix) : std::nullopt;
  if (!pose) throw std::invalid_argument("");
  return pose;
}

/// @throws std::invalid_argument naming the line and what was expected
std::optional<Eigen::Isometry3d> pose_at(const std::string& name, const WordLine& line,
                                         const std::vector<std::string>& words, const char* expected) {
  try {
    return pose_of(words);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(name + ", line " + std::to_string(line.number) + ": " + expected);
  }
}

NumberedPoses poses_of_log(const std::vector<WordLine>& lines, const std::string& name) {
  constexpr double most_pictures = 1e9;
  NumberedPoses numbered{{}, true};
  for (std::size_t at = 0; at < lines.size(); at += 5) {
    const auto refuse = [&](const std::string& what) {
      throw std::invalid_argument(name + ", line " + std::to_string(lines[at].number) + ": " + what);
    };
    const auto number = finite_number(lines[at].words.front());
    if (lines[at].words.size() != 3 || !number || *number < 0 || *number > most_pictures ||
        *number != static_cast<double>(static_cast<std::size_t>(*number)))
      refuse("expected three whole numbers, the first of them the picture's");
    std::vector<std::string> words;
    for (std::size_t row = at + 1; row < std::min(at + 5, lines.size()); ++row)
      words.insert(words.end(), lines[row].words.begin(), lines[row].words.end());
    if (words.size() != 16) refuse("expected four rows of four numbers after it");
    const auto pose = pose_at(name, lines[at], words, expected_matrix);
    if (!numbered.poses.emplace(static_cast<std::size_t>(*number), pose).second)
      refuse("picture " + lines[at].words.front() + " has a second pose");
  }
  return numbered;
}

/// Three rows of a matrix for each picture, in their order (SUN3D's extrinsics). @throws
/// std::invalid_argument also for four rows, as Neural RGB-D's, whose axes are not known to be ours
NumberedPoses poses_of_rows(const std::vector<WordLine>& lines, const std::string& name) {
  const auto is_last_row = [](const WordLine& line) {
    return line.words.size() == 4 && std::all_of(line.words.begin(), line.words.begin() + 3,
                                                 [](const auto& word) { return finite_number(word) == 0.0; });
  };
  if (lines.size() >= 4 && is_last_row(lines[3]))
    throw std::invalid_argument(
        name +
        " has matrices of four rows one below the other, whose axes differ between data sets: expected "
        "16 numbers a line, world_from_camera with x right, y down and z forward");
  NumberedPoses numbered;
  for (std::size_t at = 0; at < lines.size(); at += 3) {
    std::vector<std::string> words;
    for (std::size_t row = at; row < std::min(at + 3, lines.size()); ++row)
      if (lines[row].words.size() == 4)
        words.insert(words.end(), lines[row].words.begin(), lines[row].words.end());
    const auto pose =
        pose_at(name, lines[at], words, "expected three rows of four numbers, a rigid transform");
    numbered.poses.emplace(numbered.poses.size(), pose);
  }
  return numbered;
}

}  // namespace

std::optional<Eigen::Isometry3d> parse_pose_matrix(const std::string& text, const std::string& name) {
  const std::vector<std::string> words = words_in(text);
  try {
    return pose_of(words);
  } catch (const std::invalid_argument&) {
  }
  throw std::invalid_argument(name + ": " + expected_matrix);
}

std::optional<NumberedPoses> parse_numbered_poses(const std::string& text, const std::string& name) {
  const std::vector<WordLine> lines = word_lines(text);
  const std::size_t width = lines.empty() ? 0 : lines.front().words.size();
  if (width == 3) return poses_of_log(lines, name);
  if (width == 4) return poses_of_rows(lines, name);
  if (width != 12 && width != 16) return std::nullopt;
  const char* const expected = width == 12 ? "expected 12 numbers, the three rows of a rigid transform"
                                           : "expected 16 numbers, the four rows of a rigid transform";
  NumberedPoses numbered;
  for (const WordLine& line : lines) {
    const bool is_whole = line.words.size() == width;
    const auto pose = pose_at(name, line, is_whole ? line.words : std::vector<std::string>(), expected);
    numbered.poses.emplace(numbered.poses.size(), pose);
  }
  return numbered;
}

}  // namespace clearway
