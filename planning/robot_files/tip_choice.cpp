#include "planning/robot_files/tip_choice.hpp"

#include <string_view>
#include <vector>

#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {
namespace {

/// What begins the name of an own tip that is not its link's frame.
constexpr std::string_view own_tip = "own tip on ";

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

  /// Ends on the parent of a link that are not on the link itself.
  std::vector<std::string> ends_beside(std::size_t link) const {
    std::vector<std::string> names;
    const std::size_t above = parent(link);
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      if (is_end_[i] && i != above && hangs_on(i, above) && !hangs_on(i, link))
        names.push_back(robot_.links[i].name);
    return names;
  }

 private:
  bool hangs_on(std::size_t link, std::size_t above) const {
    while (link > above) link = parent(link);  // parents come first
    return link == above;
  }

  const Robot& robot_;
  std::vector<int> depth_;
  std::vector<bool> is_end_;
};

}  // namespace

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
  return !robot.group.empty() && !robot.srdf.empty() &&
         !tip_of_group(read_srdf(robot.srdf), robot.group).empty();
}

std::string tip_doubt(const Robot& robot) {
  if (is_tip_chosen(robot)) return {};
  const auto tip = static_cast<std::size_t>(robot.tip_link);
  const Branches branches(robot);
  std::string why;
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
