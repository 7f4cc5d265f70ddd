#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/joint_stream.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// Whether a joint can be at a value, rad or m: at most a whole turn beyond its limits (turns that encoders
/// count on are no fault), or for one that slides within 1 m or ten times its way. Others are in other units.
/// Limits may be narrower than the joint's own, for planning.
bool is_possible(const Joint& joint, double value);

/// When a joint's readings, position by time, are where it cannot be, rising.
std::vector<double> impossible_times(const Joint& joint, const std::map<double, double>& readings);

/// Whether these are no glitches, which come alone, but of other units, which go on: two readings in a row,
/// or more than one in ten. @param impossible as impossible_times
bool are_in_other_units(const std::vector<double>& impossible, const std::map<double, double>& readings);

/// Refuses a value at which a joint cannot be (is_possible).
/// @param where the value is from, as a sentence begins
/// @throws std::invalid_argument "<where>: joint 'elbow' reads -90 rad, its limits are -3.14 and 3.14 rad: …"
void require_possible(const Joint& joint, double value, const std::string& where);

/// The clause that says how far a value is beyond the joint's limits, whole turns aside, by more than 0.1 rad
/// or 0.02 m; nothing: it is not.
std::optional<std::string> beyond_limits(const Joint& joint, double value);

/// A setup's robot in its place, with the joints that a stream says were elsewhere than where planning holds
/// them.
struct RobotAsRead {
  Robot robot;
  std::map<std::string, double> held_at;  ///< of the joints that planning holds and the stream has: where
  std::vector<std::string> doubts;  ///< clauses, of joints that may move and stay held, always or at times
};

/// The robot whose joints are those of its planning group, and of the others those that the stream has: in
/// their units, and known at half of the times, or more, at which the group's first joint was read. At other
/// times they are where planning holds them (`held_at`, rad or m at the robot's scale). The tip is that of
/// the group.
/// @throws std::invalid_argument as load_robot does, or naming a joint of the group that the stream lacks, or
/// one of `joint_names` that the robot lacks
RobotAsRead robot_as_read(const RobotSetup& setup, const JointStream& joints);

}  // namespace clearway
