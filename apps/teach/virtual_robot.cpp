#include "apps/teach/virtual_robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "apps/query/query.hpp"
#include "apps/teach/taught_loads.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/follow_tip.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {
namespace {

Configuration middle_of_limits(const Robot& robot) {
  Configuration q = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j)
    q[static_cast<Eigen::Index>(j)] = std::clamp(0.0, robot.joints[j].lower, robot.joints[j].upper);
  return q;
}

}  // namespace

VirtualRobot::VirtualRobot(const RobotChoice& choice, const std::vector<double>& near,
                           const std::optional<Eigen::Isometry3d>& map_from_base)
    : choice_(choice), robot_(choose_robot(choice)), policies_(choose_policies(choice.policies, robot_)) {
  require_one_tip(robot_);
  if (map_from_base && choice.base.empty()) robot_.map_from_base = *map_from_base;
  if (near.empty()) {
    near_ = middle_of_limits(robot_);
    return;
  }
  near_ = Eigen::Map<const Configuration>(near.data(), static_cast<Eigen::Index>(near.size()));
  if (near.size() != robot_.dof())
    throw std::invalid_argument("near: got " + counted(near.size(), "value") + ", expected " +
                                std::to_string(robot_.dof()) + ", one for each joint of robot '" +
                                robot_.name + "'");
  if (const std::string beyond = limit_violation(robot_, near_); !beyond.empty())
    throw std::invalid_argument("near: " + beyond);
  q_ = near_;
  is_led_ = true;
}

const std::string& VirtualRobot::tip_link() const {
  return robot_.links.at(static_cast<std::size_t>(robot_.tip_link)).name;
}

double VirtualRobot::padding() const { return choose_padding(choice_, robot_); }

std::vector<std::string> VirtualRobot::painted_parts() const {
  const auto is_painted = [this](const std::string& part) {
    if (const auto chosen = policies_.parts.find(part); chosen != policies_.parts.end())
      return chosen->second == Policy::painted;
    const auto& critical = robot_.critical_parts;
    return policies_.critical_by_default ? std::find(critical.begin(), critical.end(), part) != critical.end()
                                         : policies_.other == Policy::painted;
  };
  std::vector<std::string> parts;
  for (const Body& body : robot_.bodies)
    if (is_painted(body.part) && std::find(parts.begin(), parts.end(), body.part) == parts.end())
      parts.push_back(body.part);
  return parts;
}

void VirtualRobot::lead(const Eigen::Isometry3d& map_from_tip, double time) {
  led_at_ = time;
  if (!is_led_) {
    const std::vector<Configuration> found = goal_configurations(robot_, map_from_tip, near_);
    reason_ = found.empty() ? "no configuration of robot '" + robot_.name + "' puts its tip there" : "";
    if (found.empty()) return;
    q_ = found.front();
    is_led_ = true;
    return;
  }
  FollowedTip followed = follow_tip(robot_, map_from_tip, q_);
  q_ = std::move(followed.q);
  reason_ = std::move(followed.reason);
}

std::string VirtualRobot::take_next_branch() {
  if (!is_led_)
    throw std::invalid_argument("the robot stands nowhere yet; the gripper probe, or 'near', says where");
  GoalPose pose{.map_from_tip = tip_pose(robot_, q_)};
  if (joints_of_tip(robot_) < 6) pose.turn_tolerance = std::numbers::pi;
  const std::vector<Configuration> found = pose.is_exact()
                                               ? goal_configurations(robot_, pose.map_from_tip, near_)
                                               : goal_configurations(robot_, pose, near_);
  constexpr std::size_t most_branches = 16;  // shoulder, elbow and wrist, with half turns; more: it floats
  if (joints_of_tip(robot_) > 6 || found.size() > most_branches)
    throw std::invalid_argument("the joints of robot '" + robot_.name +
                                "' can move while its tip stands: it has no separate arm configurations");
  const auto apart = [this](const Configuration& q) {
    return (by_whole_turns(robot_, q, q_) - q_).lpNorm<Eigen::Infinity>();
  };
  const auto present =
      std::min_element(found.begin(), found.end(),
                       [&](const Configuration& a, const Configuration& b) { return apart(a) < apart(b); });
  if (found.size() < 2) throw std::invalid_argument("no other arm configuration has the tip there");
  const auto next = std::next(present) == found.end() ? found.begin() : std::next(present);
  q_ = by_whole_turns(robot_, *next, q_);
  return std::to_string(next - found.begin() + 1) + " of " + std::to_string(found.size());
}

std::string VirtualRobot::not_there(double time) const {
  if (!led_at_) return "the gripper probe was not seen yet, since this robot was chosen";
  if (time - *led_at_ > longest_gap)
    return "the gripper probe was not seen for " + short_text(time - *led_at_, 2) + " s";
  return reason_;
}

std::shared_ptr<const ConfigurationSpace> VirtualRobot::space(const Snapshot& map, std::size_t version) {
  if (!space_ || version != version_)
    space_ = std::make_shared<const ConfigurationSpace>(padded_space(robot_, map, policies_, padding(), 0.0));
  version_ = version;
  return space_;
}

std::shared_ptr<const ConfigurationSpace> VirtualRobot::space(const Snapshot& map, std::size_t version,
                                                              const std::vector<Load>& held) {
  std::shared_ptr<const ConfigurationSpace> bare = space(map, version);
  if (held.empty()) return bare;
  if (loaded_ && version == loaded_version_ && are_same(held, held_)) return loaded_;
  Robot loaded = robot_;
  for (const Load& load : held) loaded = with_load(loaded, load);
  const Policies policies{.parts = bare->policies(), .other = Policy::not_occupied};
  loaded_ = std::make_shared<const ConfigurationSpace>(padded_space(loaded, map, policies, padding(), 0.0));
  loaded_version_ = version;
  held_ = held;
  return loaded_;
}

}  // namespace clearway
