#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace clearway {

/// Poses of one moving body over time, and where it was in between: straight line and shortest turn between
/// the reading before and the one after (mrpt::poses::CPose3DInterpolator). Nothing is guessed beyond the
/// first and last reading, nor across a gap, nor, where it is asked for, within a jump.
class PoseStream {
 public:
  /// @param max_gap longest time between the two readings around an answer, seconds, > 0
  explicit PoseStream(double max_gap = 0.5);
  ~PoseStream();
  PoseStream(PoseStream&&) noexcept;
  PoseStream& operator=(PoseStream&&) noexcept;

  /// Adds a reading, in any order; a second one at the same time replaces the first.
  /// @throws std::invalid_argument for a time or pose that is not finite.
  void add(double time, const Eigen::Isometry3d& pose);

  /// The pose at `time`; empty before the first reading, after the last, in a gap longer than max_gap, or
  /// within a jump.
  std::optional<Eigen::Isometry3d> at(double time) const;

  /// Two readings between which the body jumps, as a map's odometry does when the robot finds out where it
  /// is: by more than 0.3 m, five times as fast as it usually moves, or by more than 0.3 rad, five times as
  /// fast as it usually turns; where it hardly ever does, by more than 60 m/s or 30 rad/s.
  struct Jump {
    double before = 0.0, after = 0.0;  ///< s
    double shift = 0.0, turn = 0.0;    ///< from the one to the other, m and rad
  };
  /// Finds the jumps among the readings that there are: from now on nothing is said within them.
  void leave_out_jumps();
  const std::vector<Jump>& jumps() const;  ///< in time; none before leave_out_jumps()
  bool is_in_jump(double time) const;

  /// The reading nearest in time; empty when none lies within max_gap, or the body jumps there.
  std::optional<Eigen::Isometry3d> nearest(double time) const;

  /// Times of the last reading not after `time` and of the first one not before it.
  struct Around {
    std::optional<double> before, after;
  };
  Around around(double time) const;

  /// Times of the first and of the last reading; empty without one.
  std::optional<double> first_time() const;
  std::optional<double> last_time() const;
  std::size_t size() const;

  /// m/s from one reading to the next, the middle of those that moved; empty: fewer than five did.
  std::optional<double> usual_speed() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
