#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/joint_stream.hpp"
#include "mapping/scans/scan.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// A robot that moves while scans are taken: its own bodies are taken out of each scan where it was then.
///
/// A point is its own when it lies within a body, grown by what is not known of the body's place: the setup's
/// self_margin and place_error; and for each joint that moves the body its lever times how far the joint was
/// from its place within `latency` before and after the scan, and times joint_error. Nothing farther is taken
/// out.
class MovingRobot {
 public:
  /// @throws std::invalid_argument naming a joint of the robot that the stream does not have.
  MovingRobot(const RobotSetup& setup, JointStream joints);

  /// Takes the robot's points out of a scan in its place. @return how many; empty where the joints are not
  /// known at the scan's time (the scan stays as it is).
  std::optional<std::size_t> take_out(Scan& scan) const;

  /// By how much each body is grown at that time, metres. @pre the joints are known then
  std::vector<double> growths(double time) const;

 private:
  const RobotSetup& setup_;
  JointStream joints_;
  Robot robot_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> levers_;  ///< of each body and joint, metres a radian
};

}  // namespace clearway
