#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
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

/// Poses from text in the format of the TUM RGB-D benchmark: lines "time x y z qx qy qz qw" (m, and times as
/// make_seconds reads them); `#` starts a comment. A head before the first pose, commented out or not, may
/// say that the quaternion begins with w ("# time tx ty tz qw qx qy qz"). Lines apart by commas need a head,
/// as some programs begin with w there (VINS-Mono) and some do not; it may name more columns behind these,
/// which are skipped (EuRoC's data.csv), or give the time as seconds and nanoseconds of it, possibly behind a
/// counter (Newer College's "#sec,nsec,x,y,z,qx,qy,qz,qw").
/// @param left_out counts lines whose pose is not known (nan) and a last one that is cut off; none: they are
/// refused @throws std::invalid_argument naming `name`, the line and what was expected.
PoseStream parse_tum_poses(const std::string& text, const std::string& name, double max_gap,
                           std::size_t* left_out = nullptr);

/// The same from a file of at most 256 MB. @throws std::invalid_argument also when it cannot be read.
PoseStream load_tum_poses(const std::filesystem::path& file, double max_gap, std::size_t* left_out = nullptr);

/// The sentence about poses that can hardly be metres, as those in millimetres are: they usually move at more
/// than 60 m/s. Empty: they do not.
std::optional<std::string> too_fast_poses(const std::filesystem::path& file, const PoseStream& poses);

/// The sentence about poses that jump, between which nothing is placed. Empty: none do.
std::optional<std::string> jumping_poses(const std::filesystem::path& file, const PoseStream& poses);

/// The sentence about so many lines that were left out.
std::string left_out_poses(const std::filesystem::path& file, std::size_t left_out);

}  // namespace clearway
