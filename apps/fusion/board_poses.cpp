#include "apps/fusion/board_poses.hpp"

#include <algorithm>

#include "apps/fusion/painter.hpp"

namespace clearway {
namespace {

constexpr double probe_gap = 0.5;  ///< s: where the probe was longer ago says nothing of where it is

bool is_sure(const std::optional<BodyPose>& pose, const AcceptanceOptions& acceptance) {
  return pose && is_explained(*pose, acceptance) && pose->ambiguity_ratio >= acceptance.min_ambiguity_ratio;
}

}  // namespace

BoardPoses::BoardPoses(const Setup& setup) : setup_(setup), options_(tracking_options(setup)) {
  const auto follow = [&](const std::string& name, double max_gap) {
    const auto found = boards_.find(name);
    if (found != boards_.end()) max_gap = std::max(max_gap, found->second.max_gap);
    boards_.insert_or_assign(name, Tracked{tag_body(*setup.board(name)), max_gap, PoseStream(max_gap)});
  };
  for (const SensorSetup& sensor : setup.sensors) {
    if (!sensor.board.empty()) follow(sensor.board, sensor.max_gap);
  }
  if (setup.probe) {
    probe_board_ = setup.probe->board;
    follow(probe_board_, probe_gap);
  }
  if (setup.gripper) follow(setup.gripper->board, probe_gap);
  if (boards_.empty()) return;
  const BoardSetup& base = fixed_board(setup, setup.probe     ? "a probe"
                                              : setup.gripper ? "a gripper"
                                                              : "a sensor on a board");
  base_ = tag_body(base);
  map_from_base_ = *base.map_from_board;
}

void BoardPoses::take(const Frame& frame, const ImageFrame& image, const std::vector<TagDetection>& tags,
                      const TrackedImage* painted) {
  if (boards_.empty()) return;
  last_image_ = std::max(frame.time, last_image_.value_or(frame.time));
  const std::vector<TagDetection>& detections = painted != nullptr ? painted->detections : tags;
  if (detections.empty()) return;
  const Camera camera = camera_of(setup_, image);
  const auto base = painted != nullptr ? painted->sample.base
                                       : estimate_body_pose(base_, detections, camera, options_.pose);
  if (!is_sure(base, options_.acceptance)) return;
  const Eigen::Isometry3d map_from_camera = map_from_base_ * base->camera_from_body.pose.inverse();
  for (auto& [name, tracked] : boards_) {
    const auto board = painted != nullptr && name == probe_board_
                           ? painted->sample.probe
                           : estimate_body_pose(tracked.body, detections, camera, options_.pose);
    if (!is_sure(board, options_.acceptance)) continue;
    tracked.poses.add(frame.time, map_from_camera * board->camera_from_body.pose);
  }
}

std::optional<Eigen::Isometry3d> BoardPoses::at(const std::string& board, double time) const {
  return boards_.at(board).poses.at(time);
}

std::optional<Eigen::Isometry3d> BoardPoses::nearest(const std::string& board, double time) const {
  return boards_.at(board).poses.nearest(time);
}

std::optional<Eigen::Isometry3d> BoardPoses::gripper_at(double time) const {
  if (!setup_.gripper) return std::nullopt;
  const PoseStream& poses = boards_.at(setup_.gripper->board).poses;
  return poses.last_time() == time ? poses.at(time) : std::nullopt;
}

PoseStream::Around BoardPoses::around(const std::string& board, double time) const {
  return boards_.at(board).poses.around(time);
}

bool BoardPoses::is_settled(const std::string& board, double time, double wait) const {
  const Tracked& tracked = boards_.at(board);
  if (finished_ || tracked.poses.last_time().value_or(-1e300) >= time) return true;
  return last_image_ && *last_image_ > time + std::max(wait, tracked.max_gap);
}

}  // namespace clearway
