#include "planning/robot_files/tip_choice.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>

#include "mapping/system/plain_text.hpp"
#include "planning/robot/tip_of_joints.hpp"

namespace clearway {
namespace {

/// What begins the name of an own tip that is not its link's frame.
constexpr std::string_view own_tip = "own tip on ";

bool hangs_on(std::size_t link, std::size_t above, const Robot& robot) {
  while (link > above) link = static_cast<std::size_t>(robot.links[link].parent);  // parents come first
  return link == above;
}

/// A robot's links as a tree.
class Branches {
 public:
  explicit Branches(const Robot& robot) : robot_(robot), is_end_(robot.links.size(), true) {
    for (std::size_t i = 1; i < robot.links.size(); ++i) is_end_[parent(i)] = false;
  }

  /// The link that the last joint above the tip moves, which could move if it is held; 0: none.
  std::size_t last_moved(std::size_t tip) const {
    while (tip > 0 && !could_move(tip)) tip = parent(tip);
    return tip;
  }

  std::size_t parent(std::size_t link) const { return static_cast<std::size_t>(robot_.links[link].parent); }

  /// Ends that a link carries along and that its tool could be.
  std::vector<std::string> ends_below(std::size_t link) const {
    std::vector<std::string> names;
    for (std::size_t i = link + 1; i < robot_.links.size(); ++i) {
      std::size_t at = i;
      while (at > link && !could_move(at) && !is_beside_tool(robot_.links[at].name)) at = parent(at);
      if (is_end_[i] && at == link) names.push_back(robot_.links[i].name);
    }
    return names;
  }

  /// Ends on the parent of a link that are not on the link itself.
  std::vector<std::string> ends_beside(std::size_t link) const {
    std::vector<std::string> names;
    const std::size_t above = parent(link);
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      if (is_end_[i] && i != above && hangs_on(i, above, robot_) && !hangs_on(i, link, robot_))
        names.push_back(robot_.links[i].name);
    return names;
  }

 private:
  bool could_move(std::size_t link) const {
    return robot_.links[link].joint >= 0 || robot_.links[link].is_held;
  }

  const Robot& robot_;
  std::vector<bool> is_end_;
};

/// The joints of a planning group that are held because somebody fixed them.
std::set<std::string> fixed_joints_of_group(const Robot& robot, const Srdf& srdf) {
  Robot free = robot;
  for (const HeldJoint& held : robot.held) {
    for (Link& link : free.links) {
      if (link.joint_name != held.name) continue;
      link.joint = static_cast<int>(free.joints.size());
      free.joints.push_back({.name = held.name});
    }
  }
  std::set<std::string> joints = joints_of_group(free, srdf, robot.group, robot.srdf);
  for (const Joint& joint : robot.joints) joints.erase(joint.name);
  return joints;
}

/// The links that joints of the planning group move, also where somebody fixed these.
class MovedLinks {
 public:
  MovedLinks(const Robot& robot, const Srdf& srdf) : robot_(robot), is_moved_(robot.links.size(), false) {
    const std::set<std::string> fixed = fixed_joints_of_group(robot, srdf);
    for (std::size_t i = 1; i < robot.links.size(); ++i) {
      const Link& link = robot.links[i];
      const bool is_above_moved = is_moved_[static_cast<std::size_t>(link.parent)];
      is_moved_[i] = link.joint >= 0 || fixed.contains(link.joint_name) || (!link.is_held && is_above_moved);
    }
  }

  /// Whether the last joint above a link, held ones included, is of the group.
  bool is_moved(std::size_t link) const { return is_moved_[link]; }

  /// Whether, of what is below a link, these joints alone move.
  bool moves_only(const std::set<std::string>& joints, std::size_t link) const {
    for (std::size_t i = link + 1; i < robot_.links.size(); ++i) {
      const int joint = robot_.links[i].joint;
      if (joint < 0 || joints.contains(robot_.joints[static_cast<std::size_t>(joint)].name)) continue;
      if (hangs_on(i, link, robot_)) return false;
    }
    return true;
  }

 private:
  const Robot& robot_;
  std::vector<bool> is_moved_;
};

/// The joints that move in an end effector's own group: none where it names no group of the robot's.
std::set<std::string> joints_of_hand(const Robot& robot, const Srdf& srdf, const std::string& group) {
  try {
    return joints_of_group(robot, srdf, group, robot.srdf);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// The link that the SRDF says the robot's planning group places; empty: it says none.
std::string stated_tip(const Robot& robot, const Srdf& srdf) {
  const std::vector<Srdf::EndEffector> effectors = end_effectors_of_group(robot, srdf);
  if (!effectors.empty() && effectors.front().parent_group == robot.group)
    return effectors.front().parent_link;
  const auto group = srdf.groups.find(robot.group);
  if (group != srdf.groups.end() && group->second.chains.size() == 1)
    return group->second.chains.front().second;
  return effectors.empty() ? "" : effectors.front().parent_link;
}

/// The link of that name. @throws std::invalid_argument where the robot has none
int stated_link(const Robot& robot, const std::string& tip) {
  const auto link = std::find_if(robot.links.begin(), robot.links.end(),
                                 [&](const Link& other) { return other.name == tip; });
  if (link == robot.links.end())
    throw std::invalid_argument(robot.srdf.string() + ": the tip of group " + quote(robot.group) +
                                " is link " + quote(tip) + ", which " + robot.name + " does not have");
  return static_cast<int>(link - robot.links.begin());
}

std::string name_of_tip(const Robot& robot) {
  return quote(robot.links[static_cast<std::size_t>(robot.tip_link)].name);
}

constexpr std::string_view nobody_says =
    ", because neither --tip nor the robot's settings or SRDF say another";

}  // namespace

std::vector<Srdf::EndEffector> end_effectors_of_group(const Robot& robot, const Srdf& srdf) {
  std::vector<Srdf::EndEffector> named, attached;
  if (robot.group.empty()) return named;
  const MovedLinks moved(robot, srdf);
  for (const Srdf::EndEffector& effector : srdf.end_effectors) {
    if (effector.parent_group == robot.group) named.push_back(effector);
    if (!effector.parent_group.empty() || effector.group == robot.group) continue;
    for (std::size_t i = 1; i < robot.links.size(); ++i)
      if (robot.links[i].name == effector.parent_link && moved.is_moved(i) &&
          moved.moves_only(joints_of_hand(robot, srdf, effector.group), i))
        attached.push_back(effector);
  }
  return named.empty() ? attached : named;
}

void place_tip(const Robot& free, const std::optional<Srdf>& srdf, Robot& robot) {
  std::set<std::string> arm;
  if (!robot.group.empty()) {
    if (const std::string tip = stated_tip(robot, *srdf); !tip.empty()) {
      robot.tip_link = stated_link(robot, tip);
      robot.tip_choice.source = TipSource::srdf;
      return;
    }
    arm = joints_of_group(free, *srdf, robot.group, robot.srdf);
  }
  const TipOfJoints tip = tip_of_joints(free, arm, robot);
  robot.tip_link = tip.link;
  robot.tip_choice = {TipSource::joints, {}, tip.finger_joint};
  for (const int other : tip.others)
    robot.tip_choice.others.push_back(robot.links[static_cast<std::size_t>(other)].name);
}

std::string tip_name(const Robot& robot) {
  const std::string& link = robot.links[static_cast<std::size_t>(robot.tip_link)].name;
  const bool is_frame_of_link = robot.link_from_tip.matrix() == Eigen::Matrix4d::Identity();
  return is_frame_of_link ? link : std::string(own_tip) + link;
}

bool is_own_tip_name(const std::string& name) { return name.starts_with(own_tip); }

void require_one_tip(const Robot& robot) {
  if (robot.tip_choice.others.empty()) return;
  throw std::invalid_argument("robot " + quote(robot.name) + " has several arms, and its tip could be link " +
                              name_of_tip(robot) + ", " + listed(robot.tip_choice.others) +
                              ": expected --tip, a planning group (--group), or tip: in its settings");
}

std::string tip_doubt(const Robot& robot) {
  if (robot.tip_choice.source != TipSource::joints) return {};
  const auto tip = static_cast<std::size_t>(robot.tip_link);
  const std::string says = "the tip is link " + name_of_tip(robot);
  const Branches branches(robot);
  if (const auto& others = robot.tip_choice.others; !others.empty())
    return says + std::string(nobody_says) + ", and " + listed(others) +
           (others.size() == 1 ? " is the end of another arm" : " are the ends of other arms");
  if (const auto others = branches.ends_below(tip); !others.empty() && !is_tool_frame(robot.links[tip].name))
    return says + ", on which " + listed(others) + (others.size() == 1 ? " hangs" : " hang") +
           std::string(nobody_says);
  if (!robot.tip_choice.finger_joint.empty())
    return says + std::string(nobody_says) + ", and joint " + quote(robot.tip_choice.finger_joint) +
           " behind it slides little, as that of a finger would";
  const std::size_t moved = branches.last_moved(tip);
  const bool is_on_moved = moved > 0 && branches.last_moved(branches.parent(moved)) > 0;
  const auto others = is_on_moved ? branches.ends_beside(moved) : std::vector<std::string>();
  if (others.empty()) return {};
  return says + std::string(nobody_says) + ", and joint " + quote(robot.links[moved].joint_name) +
         " moves it against " + listed(others) + ", as it would a finger";
}

}  // namespace clearway
