#include "datasets/poses/pose_stream.hpp"

#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DInterpolator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "datasets/sources/observation_decoder.hpp"

namespace clearway {

struct PoseStream::State {
  mrpt::poses::CPose3DInterpolator poses;
  double max_gap = 0.0;
  std::vector<PoseStream::Jump> jumps;
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
  constexpr double never = std::numeric_limits<double>::infinity();
  const Around readings = around(time);
  const double gap = readings.after.value_or(never) - readings.before.value_or(-never);
  if (gap > state_->max_gap || is_in_jump(time)) return std::nullopt;
  mrpt::poses::CPose3D pose;
  bool valid = false;
  state_->poses.interpolate(mrpt::Clock::fromDouble(time), pose, valid);
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
  if (away(best) > state_->max_gap || is_in_jump(time)) return std::nullopt;
  return isometry(mrpt::poses::CPose3D(best->second));
}

namespace {

/// The middle of the rates that are not 0, where there are five or more.
std::optional<double> usual(std::vector<double> rates) {
  constexpr std::size_t least = 5;
  std::erase(rates, 0.0);
  if (rates.size() < least) return std::nullopt;
  const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  return *middle;
}

}  // namespace

void PoseStream::leave_out_jumps() {
  std::vector<Jump> steps;
  std::vector<double> speeds, turns;
  std::optional<std::pair<double, Eigen::Isometry3d>> before;
  for (const auto& [stamp, reading] : state_->poses) {
    const double time = mrpt::Clock::toDouble(stamp);
    const Eigen::Isometry3d pose = isometry(mrpt::poses::CPose3D(reading));
    if (before && time - before->first <= state_->max_gap) {
      const Eigen::Isometry3d step = before->second.inverse() * pose;
      steps.push_back({before->first, time, step.translation().norm(),
                       std::abs(Eigen::AngleAxisd(step.linear()).angle())});
      speeds.push_back(steps.back().shift / (time - before->first));
      turns.push_back(steps.back().turn / (time - before->first));
    }
    before.emplace(time, pose);
  }
  constexpr double least = 0.3;  // m, rad
  constexpr double times = 5.0, fastest = 60.0, fastest_turn = 30.0;
  const auto of_usual = [&](const std::vector<double>& rates, double otherwise) {
    const auto found = usual(rates);
    return found ? times * *found : otherwise;
  };
  const double most = of_usual(speeds, fastest), most_turn = of_usual(turns, fastest_turn);
  state_->jumps.clear();
  for (std::size_t i = 0; i < steps.size(); ++i)
    if ((steps[i].shift > least && speeds[i] > most) || (steps[i].turn > least && turns[i] > most_turn))
      state_->jumps.push_back(steps[i]);
}

const std::vector<PoseStream::Jump>& PoseStream::jumps() const { return state_->jumps; }

bool PoseStream::is_in_jump(double time) const {
  const auto after = std::upper_bound(state_->jumps.begin(), state_->jumps.end(), time,
                                      [](double at, const Jump& jump) { return at < jump.after; });
  return after != state_->jumps.end() && after->before < time;
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

std::optional<double> PoseStream::usual_speed() const {
  std::vector<double> speeds;
  if (state_->poses.empty()) return std::nullopt;
  auto before = state_->poses.begin();  // the first of those that are the same: some logs repeat a pose
  for (auto next = std::next(before); next != state_->poses.end(); ++next) {
    const double way = (next->second - before->second).translation().norm();
    if (!(way > 0.0)) continue;
    const double time = mrpt::Clock::toDouble(next->first) - mrpt::Clock::toDouble(before->first);
    if (time > 0.0) speeds.push_back(way / time);
    before = next;
  }
  return usual(std::move(speeds));
}

}  // namespace clearway
