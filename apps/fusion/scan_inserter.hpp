#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/fusion/board_poses.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/fusion/held_bodies.hpp"
#include "apps/fusion/moving_robot.hpp"

namespace clearway {

/// Scans -> map: gives each its place (where the recording says, or as the setup's `sensors` do), takes the
/// robot, the probes and the hands out of it, and inserts it. Scans whose place or probe a later image will
/// show wait for that image, 32 of them at most. A scan without a place is counted, never guessed.
class ScanInserter {
 public:
  /// How many readings of a laser have each range in whole millimetres, up to the largest that there is.
  using RangeCounts = std::vector<std::size_t>;

  /// @throws std::invalid_argument: a file of poses that cannot be read, joints that are not the robot's.
  /// @param robot that moves, and is taken out of each scan; may be null
  /// @param observer hears of scans that have a place; may be null
  ScanInserter(const Setup& setup, FreeSpaceMap& map, FusionCounts& counts, const BoardPoses& boards,
               const MovingRobot* robot = nullptr, FusionObserver* observer = nullptr);

  void take(const Frame& frame, const CloudFrame& cloud);
  /// Inserts the scans whose place the images so far show.
  void release();
  /// Inserts the rest; no more images will come.
  void finish();

 private:
  struct Waiting {
    Scan scan;
    const SensorSetup* sensor = nullptr;
    std::size_t unusable = 0;    ///< CloudFrame::unusable
    std::vector<float> times{};  ///< CloudFrame::times
  };
  /// Takes out the readings of a 2D laser that say that nothing came back; with `clear_infinite` they are
  /// rays.
  void take_no_returns(Scan& scan);
  void count_ranges(const Scan& scan, RangeCounts& counts) const;
  bool is_ready(const Waiting& waiting) const;
  std::optional<Eigen::Isometry3d> place(const Waiting& waiting) const;
  std::optional<Eigen::Isometry3d> place_on_robot(const SensorSetup& sensor, double time) const;
  void insert(Waiting& waiting);

  const Setup& setup_;
  FreeSpaceMap& map_;
  FusionCounts& counts_;
  const BoardPoses& boards_;
  HeldBodies held_;
  const MovingRobot* moving_robot_;
  FusionObserver* observer_;
  std::map<std::string, PoseStream> streams_;  ///< by sensor
  std::map<std::string, int> links_;           ///< by sensor, those on the robot
  std::vector<Capsule> robot_;                 ///< map frame
  std::deque<Waiting> waiting_;
  std::map<std::string, RangeCounts> laser_ranges_;  ///< by sensor
};

}  // namespace clearway
