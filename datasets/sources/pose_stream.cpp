#include "datasets/sources/pose_stream.hpp"

#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DInterpolator.h>

#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

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

PoseStream parse_tum_poses(const std::string& text, const std::string& name, double max_gap) {
  PoseStream stream(max_gap);
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line.resize(std::min(line.find('#'), line.size()));
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string first, rest;
    if (!(words >> first)) continue;
    words.seekg(0);
    std::array<double, 8> v{};
    for (double& value : v) words >> value;
    const Eigen::Quaterniond turn(v[7], v[4], v[5], v[6]);
    const bool is_whole = words && !(words >> rest);
    if (!is_whole || !(std::abs(turn.norm() - 1.0) < 1e-2)) {  // a stream reads finite numbers alone
      throw std::invalid_argument(name + ", line " + std::to_string(number) +
                                  ": expected 'time x y z qx qy qz qw' with a unit quaternion");
    }
    Eigen::Isometry3d pose(turn.normalized());
    pose.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
    stream.add(v[0], pose);
  }
  if (stream.size() == 0) throw std::invalid_argument(name + ": expected at least one pose");
  return stream;
}

PoseStream load_tum_poses(const std::filesystem::path& file, double max_gap) {
  const std::string name = "poses " + quote_path(file.string());
  const std::string text = read_input(file, "poses", 256U << 20U);
  return parse_tum_poses(text, name, max_gap);
}

}  // namespace clearway
