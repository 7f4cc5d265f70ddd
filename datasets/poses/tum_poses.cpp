#include "datasets/poses/tum_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "datasets/cameras/lower_case.hpp"
#include "datasets/poses/pose_columns.hpp"
#include "datasets/sources/clock_seconds.hpp"
#include "datasets/sources/finite_number.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

struct TimedPose {
  double time;
  Eigen::Isometry3d pose;
};

/// Nothing when it is not eight numbers with a unit quaternion.
std::optional<TimedPose> timed_pose(const std::vector<std::string>& words, bool is_w_first) {
  if (words.size() != 8) return std::nullopt;
  std::array<double, 8> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::optional<double> number =
        finite_number(words[i].starts_with('+') ? words[i].substr(1) : words[i]);
    if (!number) return std::nullopt;
    v[i] = *number;
  }
  const Eigen::Quaterniond turn =
      is_w_first ? Eigen::Quaterniond(v[4], v[5], v[6], v[7]) : Eigen::Quaterniond(v[7], v[4], v[5], v[6]);
  if (!(std::abs(turn.norm() - 1.0) < 1e-2)) return std::nullopt;
  Eigen::Isometry3d pose(turn.normalized());
  pose.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
  return TimedPose{v[0], pose};
}

/// A time and seven words, some of which say that they are not known.
bool is_unknown_pose(const std::vector<std::string>& words) {
  return words.size() == 8 && finite_number(words.front()) &&
         std::any_of(words.begin() + 1, words.end(), [](const std::string& text) {
           const std::string word = lower_case(text);
           return word.find("nan") != std::string::npos || word.find("inf") != std::string::npos;
         });
}

/// Of two poses of one time, such as of a file that is two recordings, none is taken. Times that were rounded
/// may have two that are near each other.
void require_near(const Eigen::Isometry3d& one, const Eigen::Isometry3d& two, double time,
                  const std::string& name) {
  constexpr double near_within = 0.1;  // m, rad
  const Eigen::Isometry3d other = one.inverse() * two;
  const double turn = Eigen::AngleAxisd(other.linear()).angle();
  if (other.translation().norm() <= near_within && turn <= near_within) return;
  throw std::invalid_argument(name + ": expected one pose a time, got two that are " +
                              short_text(other.translation().norm(), 3) + " m and " + short_text(turn, 3) +
                              " rad apart at " + short_text(time, 15) + " s");
}

class TumText {
 public:
  TumText(const std::string& text, const std::string& name, std::size_t* left_out)
      : text_(text), name_(name), left_out_(left_out) {}

  std::vector<TimedPose> read() {
    std::istringstream lines(text_);
    for (std::string line; std::getline(lines, line);) {
      ++number_;
      const std::streamoff next = lines.tellg();
      is_last_ =
          next < 0 || text_.find_first_not_of(" \t\r\n", static_cast<std::size_t>(next)) == std::string::npos;
      if (poses_.empty() && take_head(line)) continue;
      take_pose(line.substr(0, line.find('#')));
    }
    if (poses_.empty()) throw std::invalid_argument(name_ + ": expected at least one pose");
    return std::move(poses_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw std::invalid_argument(name_ + ", line " + std::to_string(number_) + ": " + why);
  }

  bool take_head(const std::string& line) {
    try {
      const auto columns = columns_of_head(line);
      if (columns) columns_ = *columns;
      return columns.has_value();
    } catch (const std::invalid_argument& error) {
      refuse(error.what());
    }
  }

  void take_pose(const std::string& line) {
    std::vector<std::string> words = cells_of(line);
    if (words.empty()) return;
    if (!columns_.has_head && words.size() == 8 && line.find(',') != std::string::npos)
      refuse(
          "programs that write commas differ in where qw stands, expected a first line that names the "
          "columns, such as 'time,x,y,z,qx,qy,qz,qw' or 'time,x,y,z,qw,qx,qy,qz'");
    const PoseWords pose = pose_words(std::move(words), columns_);
    const auto timed = pose.nanoseconds ? timed_pose(pose.words, columns_.is_w_first) : std::nullopt;
    if (timed)
      poses_.push_back({timed->time + *pose.nanoseconds, timed->pose});
    else
      leave_out(pose.words);
  }

  void leave_out(const std::vector<std::string>& words) {
    const bool is_cut_off = is_last_ && !poses_.empty() && words.size() < 8;
    if (left_out_ == nullptr || !(is_cut_off || is_unknown_pose(words)))
      refuse(columns_.expected() + (words.size() == 8 || columns_.before_nanoseconds > 0
                                        ? ""
                                        : ", got " + std::to_string(words.size()) + " columns"));
    ++*left_out_;
  }

  const std::string &text_, &name_;
  std::size_t* left_out_;
  PoseColumns columns_;
  std::vector<TimedPose> poses_;
  int number_ = 0;  ///< of the line
  bool is_last_ = false;
};

/// @throws std::invalid_argument for two that stand at one time and are not the same
PoseStream stream_of(const std::vector<TimedPose>& poses, const std::string& name, double max_gap) {
  std::vector<double> times;
  for (const TimedPose& pose : poses) times.push_back(pose.time);
  make_seconds(times);
  PoseStream stream(max_gap);
  std::map<double, const Eigen::Isometry3d*> places;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto [known, is_new] = places.emplace(times[i], &poses[i].pose);
    if (!is_new) require_near(*std::exchange(known->second, &poses[i].pose), poses[i].pose, times[i], name);
    stream.add(times[i], poses[i].pose);
  }
  stream.leave_out_jumps();
  return stream;
}

}  // namespace

PoseStream parse_tum_poses(const std::string& text, const std::string& name, double max_gap,
                           std::size_t* left_out) {
  return stream_of(TumText(text, name, left_out).read(), name, max_gap);
}

PoseStream load_tum_poses(const std::filesystem::path& file, double max_gap, std::size_t* left_out) {
  const std::string name = "poses " + quote_path(file.string());
  const std::string text = read_input(file, "poses", 256U << 20U);
  return parse_tum_poses(text, name, max_gap, left_out);
}

std::optional<std::string> too_fast_poses(const std::filesystem::path& file, const PoseStream& poses) {
  constexpr double fastest = 60.0;  // m/s
  const auto speed = poses.usual_speed();
  if (!speed || *speed <= fastest) return std::nullopt;
  return "poses " + quote_path(file.string()) + " usually move at " + std::to_string(std::lround(*speed)) +
         " m/s from line to line, which are hardly metres and seconds: expected metres, not millimetres";
}

std::optional<std::string> jumping_poses(const std::filesystem::path& file, const PoseStream& poses) {
  const std::vector<PoseStream::Jump>& jumps = poses.jumps();
  if (jumps.empty()) return std::nullopt;
  const auto farthest = std::max_element(jumps.begin(), jumps.end(), [](const auto& a, const auto& b) {
    return a.shift + a.turn < b.shift + b.turn;
  });
  const std::string count = jumps.size() == 1 ? "once" : std::to_string(jumps.size()) + " times, farthest";
  return "poses " + quote_path(file.string()) + " jump " + count + " by " + short_text(farthest->shift, 3) +
         " m and " + short_text(farthest->turn, 3) + " rad between " + short_text(farthest->before, 15) +
         " and " + short_text(farthest->after, 15) + " s: what was seen within a jump is left out";
}

std::string left_out_poses(const std::filesystem::path& file, std::size_t left_out) {
  return "poses " + quote_path(file.string()) + ": " + std::to_string(left_out) +
         (left_out == 1 ? " line says" : " lines say") + " no pose (nan, or cut off) and " +
         (left_out == 1 ? "was" : "were") + " left out";
}

}  // namespace clearway
