#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/fusion/joint_readings.hpp"
#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/joint_stream.hpp"
#include "mapping/scans/scan.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Where the robot's joints were while a recording was made: the setup's joint_file, or its joint_topic in
/// the recording, under the names that the robot has for them; none when the setup names neither.
/// @throws std::invalid_argument as load_joint_states and read_joints do, for a joint_topic where the
/// recording is no bag, and for a joint_prefix or joint_names of which it has none
std::optional<JointStream> recorded_joints(const Setup& setup, const std::filesystem::path& recording);

/// A robot that moves while scans are taken: its own bodies are taken out of each scan where it was then.
///
/// A point is its own when it lies within a body, grown by what is not known of the body's place: the setup's
/// self_margin and place_error; and for each joint that moves the body its lever times how far the joint may
/// have been from its place within `latency` before and after the point was seen, between readings too
/// (JointStream::uncertainties), and times joint_error. Nothing farther is taken out.
class MovingRobot {
 public:
  /// The joints outside of the planning group move, too, where the stream has them (robot_as_read), and stand
  /// where planning holds them while they are not known.
  /// @throws std::invalid_argument naming a joint of the robot that the stream does not have, or where the
  /// stream has it in other units than radians and metres (are_in_other_units)
  MovingRobot(const RobotSetup& setup, JointStream joints);

  struct TakenOut {
    std::size_t points = 0;
    std::string unknown = {};  ///< a clause that says why nothing is known, and the scan stayed as it is
  };
  /// Moves the robot's points of a scan in its place to `taken_out`. Each point of a sweep is judged by where
  /// the robot was at the point's own time, rounded to a millisecond; half of one is added to the latency.
  /// Nothing is known where the joints of the group are not, or leave the bodies' places open by more than
  /// `most_open` between their readings.
  /// @param times s after the scan's, of each point; none: all at once
  TakenOut take_out(Scan& scan, const std::vector<float>& times = {}) const;

  /// By how much each body is grown at that time, metres. @pre the joints of the group are known then
  std::vector<double> growths(double time) const;

  /// How far any point of each body may be from where the joints put it, metres: place_error, and for each
  /// joint its lever times joint_error.
  std::vector<double> place_errors() const;

  /// When the joints that move these bodies were read, each itself, rising; of bodies that stand, all joints.
  std::vector<double> times(const std::vector<std::size_t>& bodies) const;

  /// map_from_link of all links; empty where the joints of the group are not known at that time.
  std::optional<LinkPoses> poses(double time) const;

  /// Whether each joint that moves this link is known at that time; else `poses` has it where it is held.
  bool knows(double time, int link) const;

  /// How far a point of a link may have been from its place there, as the setup's latency and the readings
  /// leave it open: metres, and radians that the link turned; at most, to first order. @pre knows(time,
  /// link), and the joints of the group are known then
  std::pair<double, double> motion(double time, int link, const Eigen::Vector3d& in_link) const;

  const Robot& robot() const { return robot_; }

  /// Clauses: joints that are held, the first reading of each joint that is beyond its limits, and readings
  /// that were left out.
  const std::vector<std::string>& doubts() const { return doubts_; }

  static constexpr double most_open = 0.1;  ///< metres

 private:
  MovingRobot(const RobotSetup& setup, RobotAsRead read, JointStream joints);
  void take(const Joint& joint);
  struct Grown;
  /// Where the joints are, or are held; empty where those of the group are not known at that time.
  std::optional<std::vector<double>> positions(double time) const;
  /// What `figures` of a stream say of each joint that is known at that time; 0 of those that are held then.
  using Figures = std::vector<double> (JointStream::*)(const std::vector<std::string>&, double, double) const;
  std::vector<double> of_known(Figures figures, double time, double span) const;
  /// How far a body may have been from where it is between the readings around that time, metres.
  double open_between_readings(double time) const;
  /// How far each joint may have been from its place within `span` s of that time.
  std::vector<double> deviations(double time, double span) const;
  std::vector<double> growths(double time, double span) const;
  /// Why the bodies' places are not known then, as a clause; empty: they are.
  std::string why_unknown(double time) const;
  /// @pre they are known
  std::vector<Grown> bodies(double time, double span) const;

  RobotSetup setup_;
  std::vector<std::string> doubts_;
  JointStream joints_;
  Robot robot_;
  std::vector<std::string> names_;
  std::map<std::string, double> held_at_;    ///< joints outside of the group, while they are not known
  std::vector<std::vector<double>> levers_;  ///< of each body and joint, metres a radian
};

}  // namespace clearway
