#include "planning/team/rigid_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace clearway {
namespace {

/// Length of the way that a point within `radius` of the origin goes from one pose to the next, at most.
double leg_length(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to, double radius) {
  const double angle = Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle();
  return (to.translation() - from.translation()).norm() + std::abs(angle) * radius;
}

}  // namespace

RigidMotion::RigidMotion(std::vector<TimedPose> poses, bool repeats)
    : poses_(std::move(poses)), repeats_(repeats) {
  if (poses_.empty()) throw std::invalid_argument("rigid motion: expected at least one pose");
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (!std::isfinite(poses_[i].time) || !poses_[i].pose.matrix().allFinite())
      throw std::invalid_argument("rigid motion: pose " + std::to_string(i + 1) + " is not finite");
    if (i > 0 && !(poses_[i].time > poses_[i - 1].time))
      throw std::invalid_argument("rigid motion: pose " + std::to_string(i + 1) +
                                  " is not later than the one before");
  }
  if (repeats_ && !poses_.back().pose.isApprox(poses_.front().pose, 1e-9))
    throw std::invalid_argument("rigid motion: it repeats, but does not end where it starts");
  repeats_ = repeats_ && poses_.size() > 1;
}

double RigidMotion::within(double time) const {
  const double first = poses_.front().time, length = poses_.back().time - first;
  if (!repeats_ || time <= poses_.back().time) return time;
  return first + std::fmod(time - first, length);
}

Eigen::Isometry3d RigidMotion::pose(double time) const {
  const double at = within(time);
  const auto next = std::upper_bound(poses_.begin(), poses_.end(), at,
                                     [](double t, const TimedPose& pose) { return t < pose.time; });
  if (next == poses_.begin()) return poses_.front().pose;
  if (next == poses_.end()) return poses_.back().pose;
  const TimedPose& before = *(next - 1);
  const double share = (at - before.time) / (next->time - before.time);
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(before.pose.linear()).slerp(share, Eigen::Quaterniond(next->pose.linear()));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turned.normalized().toRotationMatrix();
  pose.translation() =
      before.pose.translation() + share * (next->pose.translation() - before.pose.translation());
  return pose;
}

double RigidMotion::greatest_speed(double radius) const {
  double greatest = 0.0;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    greatest = std::max(greatest, leg_length(poses_[i - 1].pose, poses_[i].pose, radius) /
                                      (poses_[i].time - poses_[i - 1].time));
  }
  return greatest;
}

PlacedShape MovingObstacle::placed(double time, double period) const {
  PlacedShape placed;
  placed.shape = shape;
  placed.pose = motion.pose(time);
  const Eigen::Isometry3d next = motion.pose(time + period);
  placed.linear_velocity = (next.translation() - placed.pose.translation()) / period;
  const Eigen::AngleAxisd turn(next.linear() * placed.pose.linear().transpose());
  placed.angular_velocity = turn.axis() * (turn.angle() / period);
  return placed;
}

double MovingObstacle::greatest_speed() const { return motion.greatest_speed(shape.bounding_radius()); }

}  // namespace clearway
