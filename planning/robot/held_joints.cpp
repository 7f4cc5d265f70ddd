#include "planning/robot/held_joints.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/joint_names.hpp"
#include "planning/robot/link_pose.hpp"

namespace clearway {
namespace {

std::size_t joint_index(const Robot& robot, const std::string& name, const std::filesystem::path& file) {
  const std::vector<std::string> names = joint_names(robot);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  for (const Link& link : robot.links)
    if (link.joint_name == name && link.joint >= 0)
      throw std::invalid_argument(
          file.string() + ": joint " + quote(name) + " cannot be fixed, because it follows " +
          quote(names[static_cast<std::size_t>(link.joint)]) + " (mimic), expected that one");
  throw std::invalid_argument(file.string() + ": joint " + quote(name) +
                              " cannot be fixed, because no joint of that name moves, " +
                              suggestion(name, names));
}

void require_within_limits(const Joint& joint, double value, const std::filesystem::path& file) {
  if (std::isfinite(value) && value >= joint.lower && value <= joint.upper) return;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << file.string() << ": joint " << quote(joint.name) << " is fixed at " << value
       << ", expected a number within its limits " << joint.lower << " to " << joint.upper;
  const double turned = value * std::numbers::pi / 180.0;
  if (joint.kind == JointKind::revolute && std::abs(value) > 2.0 * std::numbers::pi &&
      turned >= joint.lower && turned <= joint.upper)
    text << " (radians; in degrees it would be within them: " << turned << ")";
  throw std::invalid_argument(text.str());
}

/// MoveIt's assistant writes states with four digits: what one of them rounds beyond a limit is the limit.
/// @param unit 1, or the robot's scale for what was a length
double within_rounded_limits(const Joint& joint, double value, double unit = 1.0) {
  const double half_digit = 5.0001e-5 * unit;
  const double nearest = std::clamp(value, joint.lower, joint.upper);
  return std::abs(value - nearest) <= half_digit ? nearest : value;
}

}  // namespace

Robot with_held_joints(const Robot& robot, const std::vector<HeldJoint>& held,
                       const std::filesystem::path& file) {
  Robot result = robot;
  std::vector<std::optional<double>> value(robot.dof());
  for (HeldJoint joint : held) {
    const std::filesystem::path where = joint.source == HoldSource::asked ? "--fix" : file;
    const std::size_t index = joint_index(robot, joint.name, where);
    if (joint.source == HoldSource::default_state)
      joint.value = within_rounded_limits(robot.joints[index], joint.value);
    require_within_limits(robot.joints[index], joint.value, where);
    value[index] = joint.value;
    result.held.push_back(joint);
  }
  std::vector<int> kept(robot.dof(), -1);
  result.joints.clear();
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    if (value[j]) continue;
    kept[j] = static_cast<int>(result.joints.size());
    result.joints.push_back(robot.joints[j]);
  }
  const bool is_asked = std::any_of(held.begin(), held.end(),
                                    [](const HeldJoint& joint) { return joint.source == HoldSource::asked; });
  if (result.joints.empty())
    throw std::invalid_argument((is_asked ? "--fix" : file.string()) +
                                ": every joint is fixed, expected at least one that moves" +
                                (robot.group.empty() ? " (--group)" : ""));
  for (Link& link : result.links) {
    if (link.joint < 0) continue;
    const auto joint = static_cast<std::size_t>(link.joint);
    if (!value[joint]) {
      link.joint = kept[joint];
      continue;
    }
    const auto of = std::find_if(held.begin(), held.end(),
                                 [&](const HeldJoint& one) { return one.name == robot.joints[joint].name; });
    if (link.joint_name != robot.joints[joint].name)
      result.held_followers.push_back(
          {link.joint_name, link.multiplier * *value[joint] + link.offset, of->source});
    link.parent_from_link = pose_on_parent(robot, link, *value[joint]);
    link.joint = -1;
    link.multiplier = 1.0;
    link.offset = 0.0;
    link.own_kind.reset();
    link.is_held = true;
  }
  if (!held.empty()) result.inverse_kinematics = "numeric";  // geometric ones ask for all joints
  std::sort(result.held.begin(), result.held.end(),
            [](const HeldJoint& a, const HeldJoint& b) { return a.name < b.name; });
  return result;
}

namespace {

const NamedState* state_called(const Robot& robot, const std::string& name) {
  const auto found = std::find_if(robot.states.begin(), robot.states.end(),
                                  [&](const NamedState& known) { return known.name == name; });
  return found == robot.states.end() ? nullptr : &*found;
}

/// Refuses a state, as that of a subgroup, that leaves joints of the robot's configurations open.
void require_all_joints(const Robot& robot, const NamedState& state) {
  std::vector<std::string> unsaid;
  for (const Joint& joint : robot.joints)
    if (!state.values.contains(joint.name)) unsaid.push_back(joint.name);
  if (unsaid.empty()) return;
  const bool is_one = unsaid.size() == 1;
  const std::string whole = robot.group.empty() ? "all joints" : "the whole group " + quote(robot.group);
  throw std::invalid_argument(
      "state " + quote(state.name) + " of " + robot.srdf.string() + " says nothing of " +
      (is_one ? "joint " + quote(unsaid.front()) : "joints " + listed(unsaid)) + ", expected a state of " +
      whole + ", or --fix JOINT=VALUE for " + (is_one ? "that joint" : "each of them"));
}

/// Refuses a state that has a joint elsewhere than where it is held unasked: what is planned from there would
/// not be where the robot is.
void require_held_as_said(const Robot& robot, const NamedState& state) {
  constexpr double rounding = 1e-4;
  for (const HeldJoint& follower : robot.held_followers) {
    const auto value = state.values.find(follower.name);
    if (follower.source == HoldSource::asked || value == state.values.end()) continue;
    if (state.aside.contains(follower.name) || std::abs(value->second - follower.value) <= rounding) continue;
    throw std::invalid_argument("state " + quote(state.name) + " of " + robot.srdf.string() + " has joint " +
                                quote(follower.name) + " at " + short_text(value->second) +
                                ", which mimics one that is held, and is at " + short_text(follower.value) +
                                ": expected --fix of the joint that it mimics");
  }
  for (const HeldJoint& held : robot.held) {
    const auto value = state.values.find(held.name);
    if (held.source == HoldSource::asked || value == state.values.end()) continue;
    if (state.aside.contains(held.name)) continue;
    if (std::abs(value->second - held.value) <= rounding) continue;
    throw std::invalid_argument("state " + quote(state.name) + " of " + robot.srdf.string() + " has joint " +
                                quote(held.name) + " at " + short_text(value->second) +
                                ", which is held at " + short_text(held.value) + ": expected --fix " +
                                held.name + "=" + short_text(value->second) + ", or " + held.name + "=" +
                                short_text(held.value) + " where it is there all the same");
  }
}

}  // namespace

std::optional<Configuration> named_configuration(const Robot& robot, const std::string& state) {
  const NamedState* found = state_called(robot, state);
  if (found == nullptr) return std::nullopt;
  require_all_joints(robot, *found);
  return named_configuration(robot, state, Configuration::Zero(static_cast<Eigen::Index>(robot.dof())));
}

std::optional<Configuration> named_configuration(const Robot& robot, const std::string& state,
                                                 const Configuration& others) {
  if (const NamedState* found = state_called(robot, state)) require_held_as_said(robot, *found);
  return moving_joints_of(robot, state, others);
}

std::optional<Configuration> moving_joints_of(const Robot& robot, const std::string& state,
                                              const Configuration& others) {
  const NamedState* found = state_called(robot, state);
  if (found == nullptr) return std::nullopt;
  Configuration q = others;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const auto value = found->values.find(joint.name);
    if (value == found->values.end()) continue;
    if (const auto doubt = found->doubts.find(joint.name); doubt != found->doubts.end())
      throw std::invalid_argument("state " + quote(state) + " of " + robot.srdf.string() + ": " +
                                  doubt->second);
    const double unit = joint.kind == JointKind::prismatic ? robot.scale : 1.0;
    q[static_cast<Eigen::Index>(j)] = within_rounded_limits(joint, value->second * unit, unit);
  }
  if (const std::string why = limit_violation(robot, q); !why.empty())
    throw std::invalid_argument("state " + quote(state) + " of " + robot.srdf.string() + ": " + why);
  return q;
}

std::vector<std::size_t> joints_left_open(const Robot& robot, const std::string& state) {
  std::vector<std::size_t> open;
  if (const NamedState* found = state_called(robot, state))
    for (std::size_t j = 0; j < robot.dof(); ++j)
      if (!found->values.contains(robot.joints[j].name)) open.push_back(j);
  return open;
}

}  // namespace clearway
