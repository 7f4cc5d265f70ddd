#include "datasets/sources/robot_path.hpp"

#include <algorithm>

namespace clearway {

void RobotPath::add(DecodedFrame&& decoded) {
  if (!timed_ && decoded.frame.time != DecodedFrame::unknown_time) set_first_time(decoded.frame.time);
  const auto* odometry = std::get_if<OdometryFrame>(&decoded.frame.content);
  const bool moves = odometry && !decoded.posed;
  if (moves) {
    before_ = after_;
    after_ = Waypoint{decoded.frame.time, odometry->world_from_robot};
  }
  waiting_.push_back(std::move(decoded));
  const bool complete = timed_ && (moves || waiting_.front().posed);
  if (complete || waiting_.size() > capacity_) release_all();
}

void RobotPath::finish() { release_all(); }

void RobotPath::set_first_time(double time) {
  timed_ = true;
  for (auto& decoded : waiting_) decoded.frame.time = time;
}

void RobotPath::release_all() {
  if (!timed_) set_first_time(0);
  for (auto& decoded : waiting_) {
    if (!decoded.posed) place(decoded.frame);
    ready_.push_back(std::move(decoded.frame));
  }
  waiting_.clear();
}

void RobotPath::place(Frame& frame) const {
  if (!after_) return;  // no odometry so far: the robot stands at the origin
  Eigen::Isometry3d world_from_robot = after_->world_from_robot;
  if (before_ && after_->time > before_->time) {
    const double part = std::clamp((frame.time - before_->time) / (after_->time - before_->time), 0.0, 1.0);
    const auto &from = before_->world_from_robot, &to = after_->world_from_robot;
    world_from_robot.translation() = (1 - part) * from.translation() + part * to.translation();
    world_from_robot.linear() =
        Eigen::Quaterniond(from.linear()).slerp(part, Eigen::Quaterniond(to.linear())).toRotationMatrix();
  }
  if (auto* image = std::get_if<ImageFrame>(&frame.content))
    image->world_from_sensor = world_from_robot * image->world_from_sensor;
  if (auto* cloud = std::get_if<CloudFrame>(&frame.content))
    cloud->world_from_sensor = world_from_robot * cloud->world_from_sensor;
}

std::optional<Frame> RobotPath::take() {
  if (ready_.empty()) return std::nullopt;
  Frame frame = std::move(ready_.front());
  ready_.pop_front();
  return frame;
}

}  // namespace clearway
