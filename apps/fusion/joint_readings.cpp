#include "apps/fusion/joint_readings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include "apps/query/setup_robot.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/joint_names.hpp"

namespace clearway {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// How far a value is outside of the limits.
double excess(const Joint& joint, double value) {
  return std::max({joint.lower - value, value - joint.upper, 0.0});
}

std::string reading_of(const Joint& joint, double value) {
  const std::string unit = joint.kind == JointKind::revolute ? " rad" : " m";
  return "joint " + quote(joint.name) + " reads " + short_text(value) + unit + ", its limits are " +
         short_text(joint.lower) + " and " + short_text(joint.upper) + unit;
}

}  // namespace

bool is_possible(const Joint& joint, double value) {
  if (joint.kind == JointKind::revolute) return excess(joint, value) <= turn + 0.1;
  return excess(joint, value) == 0.0 || std::abs(value) <= std::max(1.0, 10.0 * (joint.upper - joint.lower));
}

std::vector<double> impossible_times(const Joint& joint, const std::map<double, double>& readings) {
  std::vector<double> times;
  for (const auto& [time, position] : readings)
    if (!is_possible(joint, position)) times.push_back(time);
  return times;
}

bool are_in_other_units(const std::vector<double>& impossible, const std::map<double, double>& readings) {
  const auto follow = [&](double time, double next) {
    return std::next(readings.find(time)) == readings.find(next);
  };
  return 10 * impossible.size() > readings.size() ||
         std::adjacent_find(impossible.begin(), impossible.end(), follow) != impossible.end();
}

void require_possible(const Joint& joint, double value, const std::string& where) {
  const bool turns = joint.kind == JointKind::revolute;
  if (is_possible(joint, value)) return;
  throw std::invalid_argument(
      where + ": " + reading_of(joint, value) +
      (turns ? ": expected radians; are these degrees?" : ": expected metres; are these millimetres?"));
}

std::optional<std::string> beyond_limits(const Joint& joint, double value) {
  const bool turns = joint.kind == JointKind::revolute;
  double least = excess(joint, value);
  if (turns && least > 0.0 && std::isfinite(least)) {
    // The turns that lead to the values on both sides of the limits' middle, which are the nearest to them.
    const double turns_off = (value - 0.5 * (joint.lower + joint.upper)) / turn;
    for (const double whole : {std::floor(turns_off), std::ceil(turns_off)})
      least = std::min(least, excess(joint, value - whole * turn));
  }
  if (least <= (turns ? 0.1 : 0.02)) return std::nullopt;
  return reading_of(joint, value);
}

namespace {

/// A joint of the robot that `joint_names` names must be one.
void require_own_names(const RobotSetup& setup, const Robot& robot) {
  std::vector<std::string> own = joint_names(robot);
  for (const HeldJoint& joint : robot.held) own.push_back(joint.name);
  for (const auto& [joint, name] : setup.joint_names)
    if (std::find(own.begin(), own.end(), joint) == own.end())
      throw std::invalid_argument("setup, robot, field 'joint_names': robot " + quote(robot.name) +
                                  " has no joint " + quote(joint) + ", " + suggestion(joint, own));
}

/// By which keys a setup says what the recording calls a joint.
std::string naming_hint(const std::string& joint, const std::vector<std::string>& known) {
  for (const std::string& name : known)
    if (name.ends_with(joint))
      return "`joint_prefix: " + shortened(name.substr(0, name.size() - joint.size())) +
             "` in `robot` of the setup where " + quote(name) + " is it";
  return "`joint_names: {" + shortened(joint) + ": NAME}` in `robot` of the setup where one of these is it";
}

void require_joints(const Robot& robot, const std::vector<std::string>& known) {
  for (const Joint& joint : robot.joints) {
    if (std::binary_search(known.begin(), known.end(), joint.name)) continue;
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + quote(name);
    throw std::invalid_argument("the recorded joint positions have no joint " + quote(joint.name) +
                                " of robot '" + robot.name + "', but " + shortened(list) + ": expected " +
                                naming_hint(joint.name, known));
  }
}

/// At which part of these readings of another joint this one is not known.
double unknown_part(const std::string& joint, const JointStream& joints,
                    const std::map<double, double>& others) {
  const auto unknown = std::count_if(others.begin(), others.end(), [&](const auto& reading) {
    return !joints.at({joint}, reading.first).has_value();
  });
  return static_cast<double>(unknown) / static_cast<double>(others.size());
}

/// Why the readings do not say where a joint is, as a clause; empty: they do.
/// @param others of a joint that is known
std::string why_useless(const Joint& joint, const JointStream& joints,
                        const std::map<double, double>& others) {
  const std::map<double, double>& readings = joints.readings(joint.name);
  if (const auto impossible = impossible_times(joint, readings); are_in_other_units(impossible, readings))
    return "its recorded positions cannot be (" + short_text(readings.at(impossible.front())) + " at " +
           short_text(impossible.front(), 15) + " s)";
  const bool is_known = unknown_part(joint.name, joints, others) <= 0.5;
  return is_known ? "" : "it was read too rarely for more than half of the time";
}

/// Those of `moving` that the stream is of no use for, and why.
std::map<std::string, std::string> useless_joints(const Robot& robot, const std::set<std::string>& moving,
                                                  const JointStream& joints,
                                                  const std::map<double, double>& others) {
  std::map<std::string, std::string> useless;
  for (const Joint& joint : robot.joints) {
    if (!moving.contains(joint.name)) continue;
    const std::string why = why_useless(joint, joints, others);
    if (!why.empty()) useless.emplace(joint.name, why);
  }
  return useless;
}

/// @param useless as useless_joints
std::vector<std::string> doubts_of(const Robot& robot, const std::map<std::string, std::string>& useless) {
  std::vector<std::string> doubts, missing;
  for (const HeldJoint& joint : robot.held) {
    if (const auto why = useless.find(joint.name); why != useless.end())
      doubts.push_back("joint " + quote(joint.name) + " is held at " + short_text(joint.value) + ": " +
                       why->second);
    else if (joint.source != HoldSource::settings)
      missing.push_back(joint.name);
  }
  if (!missing.empty())
    doubts.push_back("of joints that planning holds still, the recorded positions lack " + listed(missing) +
                     ": what hangs there was taken out of scans where it is held");
  return doubts;
}

/// Of joints that stand where they are held for a part of the time that is worth a word.
void add_doubts_at_times(const std::map<std::string, double>& held_at, const JointStream& joints,
                         const std::map<double, double>& others, std::vector<std::string>& doubts) {
  constexpr double least = 0.01;
  for (const auto& [joint, value] : held_at)
    if (const double part = unknown_part(joint, joints, others); part >= least)
      doubts.push_back("joint " + quote(joint) + " is held at " + short_text(value) + " for " +
                       short_text(100.0 * part, 2) + " % of the time, when it was not read");
}

/// Where planning holds these joints, at the robot's scale.
std::map<std::string, double> held_values(const Robot& planned, const Robot& read,
                                          const std::set<std::string>& moving) {
  std::map<std::string, double> values;
  for (const HeldJoint& held : planned.held)
    if (moving.contains(held.name)) values[held.name] = held.value;
  for (const Joint& joint : read.joints)
    if (const auto held = values.find(joint.name); held != values.end() && joint.kind == JointKind::prismatic)
      held->second *= read.scale;
  return values;
}

}  // namespace

RobotAsRead robot_as_read(const RobotSetup& setup, const JointStream& joints) {
  const Robot planned = recorded_robot(setup, {});
  const std::vector<std::string> known = joints.names();
  require_own_names(setup, planned);
  require_joints(planned, known);
  const std::map<double, double>& others = joints.readings(planned.joints.front().name);
  std::set<std::string> moving;
  for (const HeldJoint& joint : planned.held)
    if (std::binary_search(known.begin(), known.end(), joint.name)) moving.insert(joint.name);
  if (moving.empty()) return {planned, {}, doubts_of(planned, {})};
  Robot robot = recorded_robot(setup, moving);
  const auto useless = useless_joints(robot, moving, joints, others);
  for (const auto& [name, why] : useless) moving.erase(name);
  if (!useless.empty()) robot = recorded_robot(setup, moving);
  RobotAsRead read{robot, held_values(planned, robot, moving), doubts_of(robot, useless)};
  add_doubts_at_times(read.held_at, joints, others, read.doubts);
  return read;
}

}  // namespace clearway
