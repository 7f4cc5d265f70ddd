#include "datasets/sources/pose_stream.hpp"

#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DInterpolator.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "datasets/sources/clock_seconds.hpp"
#include "datasets/sources/finite_number.hpp"
#include "datasets/sources/observation_decoder.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

struct PoseStream::State {
  mrpt::poses::CPose3DInterpolator poses;
  double max_gap = 0.0;
};

PoseStream::PoseStream(double max_gap) : state_(std::make_unique<State>()) {
  if (!(max_gap > 0.0) || !std::isfinite(max_gap))
    throw std::invalid_argument("a pose stream's longest gap must be above 0 s");
  state_->max_gap = max_gap;
  state_->poses.setInterpolationMethod(mrpt::poses::imLinearSlerp);
}
PoseStream::~PoseStream() = default;
PoseStream::PoseStream(PoseStream&&) noexcept = default;
PoseStream& PoseStream::operator=(PoseStream&&) noexcept = default;

void PoseStream::add(double time, const Eigen::Isometry3d& pose) {
  if (!std::isfinite(time) || !pose.matrix().allFinite())
    throw std::invalid_argument("a pose stream takes finite times and poses only");
  const Eigen::Matrix3d rotation = pose.linear();
  mrpt::poses::CPose3D reading;
  reading.setRotationMatrix(mrpt::math::CMatrixDouble33(rotation));
  for (int axis = 0; axis < 3; ++axis) reading.m_coords[axis] = pose.translation()[axis];
  state_->poses.insert(mrpt::Clock::fromDouble(time), reading.asTPose());
}

std::optional<Eigen::Isometry3d> PoseStream::at(double time) const {
  if (state_->poses.empty() || !std::isfinite(time)) return std::nullopt;
  const auto stamp = mrpt::Clock::fromDouble(time);
  const auto after = state_->poses.lower_bound(stamp);
  if (after == state_->poses.end()) return std::nullopt;
  if (after->first == stamp) return isometry(mrpt::poses::CPose3D(after->second));
  if (after == state_->poses.begin()) return std::nullopt;
  const double gap = mrpt::Clock::toDouble(after->first) - mrpt::Clock::toDouble(std::prev(after)->first);
  if (gap > state_->max_gap) return std::nullopt;
  mrpt::poses::CPose3D pose;
  bool valid = false;
  state_->poses.interpolate(stamp, pose, valid);
  if (!valid) return std::nullopt;
  return isometry(pose);
}

std::optional<Eigen::Isometry3d> PoseStream::nearest(double time) const {
  if (state_->poses.empty() || !std::isfinite(time)) return std::nullopt;
  auto best = state_->poses.lower_bound(mrpt::Clock::fromDouble(time));
  const auto away = [time](const auto& reading) {
    return std::abs(mrpt::Clock::toDouble(reading->first) - time);
  };
  if (best == state_->poses.end()) best = std::prev(best);
  if (best != state_->poses.begin() && away(std::prev(best)) < away(best)) best = std::prev(best);
  if (away(best) > state_->max_gap) return std::nullopt;
  return isometry(mrpt::poses::CPose3D(best->second));
}

PoseStream::Around PoseStream::around(double time) const {
  if (state_->poses.empty() || !std::isfinite(time)) return {};
  const auto stamp = mrpt::Clock::fromDouble(time);
  const auto after = state_->poses.lower_bound(stamp);
  Around result;
  if (after != state_->poses.end()) result.after = mrpt::Clock::toDouble(after->first);
  if (after != state_->poses.end() && after->first == stamp)
    result.before = result.after;
  else if (after != state_->poses.begin())
    result.before = mrpt::Clock::toDouble(std::prev(after)->first);
  return result;
}

std::optional<double> PoseStream::first_time() const {
  if (state_->poses.empty()) return std::nullopt;
  return mrpt::Clock::toDouble(state_->poses.begin()->first);
}

std::optional<double> PoseStream::last_time() const {
  if (state_->poses.empty()) return std::nullopt;
  return mrpt::Clock::toDouble(state_->poses.rbegin()->first);
}

std::size_t PoseStream::size() const { return state_->poses.size(); }

namespace {

/// Words of a line, with commas for blanks.
std::vector<std::string> words_of(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// The order of the quaternion that a head says ("# time tx ty tz qw qx qy qz"): "xyzw"; empty when the line
/// is no head. Words are q and a letter, whatever stands between them (q_RS_w).
std::string quaternion_order(const std::string& line) {
  std::string order;
  for (std::string word : words_of(line)) {
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const char last = word.back();
    if (word.front() == 'q' && (word.size() == 2 || word[word.size() - 2] == '_') &&
        (last == 'w' || last == 'x' || last == 'y' || last == 'z'))
      order += last;
  }
  return order.size() == 4 ? order : "";
}

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

}  // namespace

PoseStream parse_tum_poses(const std::string& text, const std::string& name, double max_gap) {
  std::istringstream lines(text);
  std::vector<TimedPose> poses;
  int number = 0;
  bool is_w_first = false;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument(name + ", line " + std::to_string(number) + ": " + why);
    };
    if (const std::string order = quaternion_order(line); !order.empty() && poses.empty()) {
      if (order != "xyzw" && order != "wxyz")
        refuse("expected a quaternion as qx qy qz qw or qw qx qy qz, got " + quote(order));
      is_w_first = order == "wxyz";
      continue;
    }
    line.resize(std::min(line.find('#'), line.size()));
    const std::vector<std::string> words = words_of(line);
    if (words.empty()) continue;
    const auto pose = timed_pose(words, is_w_first);
    if (!pose)
      refuse(std::string("expected 'time x y z ") + (is_w_first ? "qw qx qy qz" : "qx qy qz qw") +
             "' with a unit quaternion");
    poses.push_back(*pose);
  }
  if (poses.empty()) throw std::invalid_argument(name + ": expected at least one pose");
  std::vector<double> times;
  for (const TimedPose& pose : poses) times.push_back(pose.time);
  make_seconds(times);
  PoseStream stream(max_gap);
  for (std::size_t i = 0; i < poses.size(); ++i) stream.add(times[i], poses[i].pose);
  return stream;
}

PoseStream load_tum_poses(const std::filesystem::path& file, double max_gap) {
  const std::string name = "poses " + quote_path(file.string());
  const std::string text = read_input(file, "poses", 256U << 20U);
  return parse_tum_poses(text, name, max_gap);
}

}  // namespace clearway
