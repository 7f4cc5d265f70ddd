#pragma once

#include <deque>
#include <optional>

#include "datasets/sources/frame_bytes.hpp"

namespace clearway {

/// Gives the frames of an observation-only log their place in the world: the odometry before and after a
/// frame are interpolated at its time (straight line, shortest turn). Frames keep their order; those that
/// wait for the next odometry are held back, at most `capacity` of them, then placed at the latest odometry.
/// Before the first odometry of a log that has any, its first reading counts. Frames before the first time
/// stamp wait for it in the same way and share it.
class RobotPath {
 public:
  explicit RobotPath(size_t capacity = 32) : capacity_(capacity) {}

  void add(DecodedFrame&& frame);
  /// No more frames will come: nothing is held back any longer.
  void finish();
  /// The next frame that has its place.
  std::optional<Frame> take();

 private:
  struct Waypoint {
    double time;
    Eigen::Isometry3d world_from_robot;
  };
  void release_all();
  void set_first_time(double time);
  void place(Frame& frame) const;

  size_t capacity_;
  std::deque<DecodedFrame> waiting_;
  std::deque<Frame> ready_;
  std::optional<Waypoint> before_, after_;
  bool timed_ = false;
};

}  // namespace clearway
