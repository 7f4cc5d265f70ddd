#include "planning/robot_files/tip_choice.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>

#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/robot_settings.hpp"

namespace clearway {
namespace {

/// What begins the name of an own tip that is not its link's frame.
constexpr std::string_view own_tip = "own tip on ";

bool includes(const std::set<int>& all, const std::set<int>& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

bool hangs_on(std::size_t link, std::size_t above, const Robot& robot) {
  while (link > above) link = static_cast<std::size_t>(robot.links[link].parent);  // parents come first
  return link == above;
}

/// A robot's links as a tree.
class Branches {
 public:
  explicit Branches(const Robot& robot)
      : robot_(robot), depth_(robot.links.size(), 0), is_end_(robot.links.size(), true) {
    for (std::size_t i = 1; i < robot.links.size(); ++i) {
      const auto parent = static_cast<std::size_t>(robot.links[i].parent);
      depth_[i] = depth_[parent] + 1;
      is_end_[parent] = false;
    }
  }

  std::vector<std::string> ends_as_deep_as(std::size_t tip) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      if (i != tip && is_end_[i] && depth_[i] == depth_[tip]) names.push_back(robot_.links[i].name);
    return names;
  }

  /// The link that the last joint above the tip moves, which could move if it is held; 0: none.
  std::size_t last_moved(std::size_t tip) const {
    while (tip > 0 && robot_.links[tip].joint < 0 && !robot_.links[tip].is_held) tip = parent(tip);
    return tip;
  }

  std::size_t parent(std::size_t link) const { return static_cast<std::size_t>(robot_.links[link].parent); }

  /// Ends below a link that no held joint parts from it.
  std::vector<std::string> ends_below(std::size_t link) const {
    std::vector<std::string> names;
    for (std::size_t i = link + 1; i < robot_.links.size(); ++i) {
      std::size_t at = i;
      while (at > link && !robot_.links[at].is_held) at = parent(at);
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
  const Robot& robot_;
  std::vector<int> depth_;
  std::vector<bool> is_end_;
};

/// Where the joints that move have links.
class MovedLinks {
 public:
  explicit MovedLinks(const Robot& robot)
      : robot_(robot), joints_(robot.links.size(), 0), last_(joints_), depth_(joints_) {
    for (std::size_t i = 1; i < robot.links.size(); ++i) {
      const Link& link = robot.links[i];
      const std::size_t above = parent(i);
      joints_[i] = joints_[above] + (link.joint >= 0 ? 1 : 0);
      depth_[i] = depth_[above] + 1;
      last_[i] = link.joint >= 0 ? static_cast<int>(i) : link.is_held ? 0 : last_[above];
    }
  }

  /// The link that the last joint above a link moves; 0: none, or a held joint is between.
  int last_moved(std::size_t link) const { return last_[link]; }

  /// Whether, of what is below a link, these joints alone move.
  bool moves_only(const std::set<std::string>& joints, std::size_t link) const {
    for (std::size_t i = link + 1; i < robot_.links.size(); ++i) {
      const int joint = robot_.links[i].joint;
      if (joint < 0 || joints.contains(robot_.joints[static_cast<std::size_t>(joint)].name)) continue;
      if (hangs_on(i, link, robot_)) return false;
    }
    return true;
  }

  /// The last link below the most joints, but for a finger the hand that it hangs on.
  int tip() const {
    std::size_t moved = 0;
    for (std::size_t i = 1; i < last_.size(); ++i)
      if (is_moved(i) && joints_[i] > joints_[moved]) moved = i;
    return moved == 0 ? 0 : end_of(hand_of(static_cast<int>(moved)));
  }

 private:
  std::size_t parent(std::size_t link) const { return static_cast<std::size_t>(robot_.links[link].parent); }
  bool is_moved(std::size_t link) const { return robot_.links[link].joint >= 0; }

  int carrier(int moved) const { return last_[parent(static_cast<std::size_t>(moved))]; }

  /// The highest link above a moved one that carries fingers; that one itself where none does.
  int hand_of(int moved) const {
    int hand = moved;
    for (int link = moved; carrier(link) > 0; link = carrier(link))
      if (is_finger(link)) hand = carrier(link);
    return hand;
  }

  /// Whether a moved link begins one of several fingers: a branch with few joints, beside which another has
  /// at least half as many. One that only mimics joints of the other mimics all of them: a rod of a
  /// parallelogram mimics some.
  bool is_finger(int moved) const {
    constexpr std::size_t most_joints = 5;  // a thumb has; arms that part at a torso have more
    const std::set<int> joints = joints_from(moved);
    for (int other = 1; other < static_cast<int>(last_.size()); ++other) {
      const bool is_beside =
          other != moved && is_moved(static_cast<std::size_t>(other)) && carrier(other) == carrier(moved);
      const std::set<int> others = is_beside ? joints_from(other) : std::set<int>();
      const bool is_mimic = includes(joints, others) || includes(others, joints);
      if (is_beside && (is_mimic ? others == joints : 2 * others.size() >= joints.size()))
        return joints.size() <= most_joints;
    }
    return false;
  }

  /// The joints that move a link and what hangs on it against what carries it, each once where others mimic
  /// it, and none that moves the carrier, too.
  std::set<int> joints_from(int moved) const {
    const auto first = static_cast<std::size_t>(moved);
    std::set<int> joints;
    for (std::size_t i = first; i < last_.size(); ++i)
      if (is_moved(i) && hangs_on(i, first, robot_)) joints.insert(robot_.links[i].joint);
    for (std::size_t above = parent(first); above > 0; above = parent(above))
      joints.erase(robot_.links[above].joint);
    return joints;
  }

  /// The last of the links that a moved one carries along; the one that several last ones have above them.
  int end_of(int moved) const {
    auto end = static_cast<std::size_t>(moved);
    int deepest = depth_[end];
    for (std::size_t i = end + 1; i < last_.size(); ++i) {
      if (last_[i] != moved || depth_[i] < deepest) continue;
      end = depth_[i] > deepest ? i : common(i, end);
      deepest = depth_[i];
    }
    return static_cast<int>(end);
  }

  std::size_t common(std::size_t a, std::size_t b) const {
    while (a != b) (a > b ? a : b) = parent(std::max(a, b));
    return a;
  }

  const Robot& robot_;
  std::vector<int> joints_, last_, depth_;
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

}  // namespace

std::vector<Srdf::EndEffector> end_effectors_of_group(const Robot& robot, const Srdf& srdf) {
  std::vector<Srdf::EndEffector> named, attached;
  if (robot.group.empty()) return named;
  const MovedLinks moved(robot);
  for (const Srdf::EndEffector& effector : srdf.end_effectors) {
    if (effector.parent_group == robot.group) named.push_back(effector);
    if (!effector.parent_group.empty() || effector.group == robot.group) continue;
    for (std::size_t i = 1; i < robot.links.size(); ++i)
      if (robot.links[i].name == effector.parent_link && moved.last_moved(i) > 0 &&
          moved.moves_only(joints_of_hand(robot, srdf, effector.group), i))
        attached.push_back(effector);
  }
  return named.empty() ? attached : named;
}

int tip_of_group(const Robot& robot, const Srdf& srdf) {
  const std::string tip = stated_tip(robot, srdf);
  if (tip.empty()) return MovedLinks(robot).tip();
  const auto link = std::find_if(robot.links.begin(), robot.links.end(),
                                 [&](const Link& other) { return other.name == tip; });
  if (link == robot.links.end())
    throw std::invalid_argument(robot.srdf.string() + ": the tip of group " + quote(robot.group) +
                                " is link " + quote(tip) + ", which " + robot.name + " does not have");
  return static_cast<int>(link - robot.links.begin());
}

std::string tip_name(const Robot& robot) {
  const std::string& link = robot.links[static_cast<std::size_t>(robot.tip_link)].name;
  const bool is_frame_of_link = robot.link_from_tip.matrix() == Eigen::Matrix4d::Identity();
  return is_frame_of_link ? link : std::string(own_tip) + link;
}

bool is_own_tip_name(const std::string& name) { return name.starts_with(own_tip); }

bool is_tip_chosen(const Robot& robot) {
  if (robot.source.empty()) return true;  // who made it in memory
  const std::filesystem::path settings =
      is_urdf_name(robot.source) ? beside_urdf(robot.source, ".yaml") : robot.source;
  if ((!is_urdf_name(robot.source) || is_input_there(settings)) &&
      !read_robot_settings(settings).tip_link.empty())
    return true;
  return !robot.group.empty() && !robot.srdf.empty() && !stated_tip(robot, read_srdf(robot.srdf)).empty();
}

std::string tip_doubt(const Robot& robot) {
  if (is_tip_chosen(robot)) return {};
  const auto tip = static_cast<std::size_t>(robot.tip_link);
  const Branches branches(robot);
  std::string why;
  if (const auto others = branches.ends_below(tip); !others.empty())
    return "the tip is link " + quote(robot.links[tip].name) + ", on which " + listed(others) +
           (others.size() == 1 ? " hangs" : " hang") +
           ", because neither --tip nor the robot's settings or SRDF say another";
  if (const auto others = branches.ends_as_deep_as(tip); !others.empty())
    why = listed(others) + (others.size() == 1 ? " is" : " are") + " at the end of as long a branch";
  const std::size_t moved = branches.last_moved(tip);
  const bool is_on_moved = moved > 0 && branches.last_moved(branches.parent(moved)) > 0;
  if (const auto others = is_on_moved ? branches.ends_beside(moved) : std::vector<std::string>();
      why.empty() && !others.empty())
    why = "joint " + quote(robot.links[moved].joint_name) + " moves it against " + listed(others) +
          ", as it would a finger";
  if (why.empty()) return {};
  return "the tip is link " + quote(robot.links[tip].name) +
         ", the end of the longest branch, because neither --tip nor the robot's settings or SRDF say "
         "another, and " +
         why;
}

}  // namespace clearway
