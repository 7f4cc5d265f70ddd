#include "apps/problem_sets/scene_frames.hpp"

#include <algorithm>
#include <vector>

#include "apps/problem_sets/own_names.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {
namespace {

const std::set<std::string> usual{"world", "map", "odom"};

/// The names of a link, without prefix. A root of another name is the link0 of links that count from 1.
std::vector<std::string> names_of(const Robot& robot, const Link& link) {
  std::vector<std::string> names{link.name};
  const auto has = [&](const char* name) {
    return std::any_of(robot.links.begin(), robot.links.end(),
                       [&](const Link& other) { return other.name == name; });
  };
  if (link.parent < 0 && has("link1") && !has("link0")) names.push_back("link0");
  return names;
}

}  // namespace

SceneFrames::SceneFrames(const std::set<std::string>& planning_frames,
                         const Eigen::Isometry3d& planning_from_base)
    : map_from_planning_(planning_from_base.inverse()) {
  for (const std::string& frame : planning_frames) add_planning_frame(frame);
}

void SceneFrames::place_links(const Robot& robot, const std::map<std::string, double>& joints) {
  links_.clear();
  unplaced_.clear();
  OwnJoints own = own_joints(robot, joints);
  own.prefixes.insert("");
  for (const std::string* name : {&robot.name, &robot.model})
    if (!name->empty()) own.prefixes.insert(*name + "_");
  Configuration q = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j)
    if (const auto value = own.values.find(robot.joints[j].name); value != own.values.end())
      q[static_cast<Eigen::Index>(j)] = value->second;
  const LinkPoses poses = forward_kinematics(robot, q);
  std::vector<bool> is_placed;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const bool is_known =
        link.joint < 0 || own.values.contains(robot.joints[static_cast<std::size_t>(link.joint)].name);
    is_placed.push_back(is_known && (link.parent < 0 || is_placed[static_cast<std::size_t>(link.parent)]));
    for (const std::string& name : names_of(robot, link))
      for (const std::string& prefix : own.prefixes)
        is_placed.back() ? void(links_.emplace(prefix + name, poses[i]))
                         : void(unplaced_.insert(prefix + name));
  }
}

void SceneFrames::place(const std::string& frame, const Eigen::Isometry3d& map_from_frame) {
  placed_.insert_or_assign(frame, map_from_frame);
}

void SceneFrames::add_planning_frame(const std::string& frame) {
  if (frame.empty()) return;
  placed_.emplace(frame, map_from_planning_);
  has_planning_frame_ = true;
}

bool SceneFrames::is_link(const std::string& frame) const {
  return links_.contains(frame) || unplaced_.contains(frame);
}

bool SceneFrames::is_planning_frame(const std::string& frame) const {
  const Eigen::Isometry3d* known = find(frame);
  return known != nullptr && !is_link(frame) && known->matrix() == map_from_planning_.matrix();
}

const Eigen::Isometry3d* SceneFrames::find(const std::string& frame, bool is_named) const {
  if (frame.empty()) return &map_from_planning_;
  for (const auto* frames : {&links_, &placed_})
    if (const auto known = frames->find(frame); known != frames->end()) return &known->second;
  const bool is_usual = !is_named && !has_planning_frame_ && usual.contains(frame) && !is_link(frame);
  return is_usual ? &map_from_planning_ : nullptr;
}

std::string SceneFrames::why_unknown(const std::string& frame) const {
  if (unplaced_.contains(frame))
    return "a link that moves, expected a state with values of all joints between it and the robot's base";
  std::vector<std::string> known;
  for (const auto& [name, pose] : placed_) known.push_back(name);
  for (const std::string& name : usual)
    if (find(name) != find(name, true)) known.push_back(name);
  for (const auto& [name, pose] : links_) known.push_back(name);
  return "which is unknown, expected one of " + listed(known);
}

}  // namespace clearway
