#include <tinyxml2.h>
#include <urdf_model/model.h>

#include <algorithm>

#include "planning/check/path_check_links.hpp"
#include "planning/robot_files/urdf_document.hpp"

namespace clearway::check {
namespace {

/// Links of the URDF that a group names, its subgroups' included, each standing for the joint above it.
class GroupLinks {
 public:
  GroupLinks(const Robot& robot, const urdf::ModelInterface& model, const tinyxml2::XMLElement& root)
      : robot_(robot), model_(model), root_(root) {}

  void add(const std::string& group) {
    if (!visited_.insert(group).second) return;
    const tinyxml2::XMLElement* found = root_.FirstChildElement("group");
    while (found && word_of(*found, "name") != group) found = found->NextSiblingElement("group");
    if (!found) disagree(robot_, "there is no group '" + group + "'");
    for (const auto* part = found->FirstChildElement(); part; part = part->NextSiblingElement()) {
      const std::string kind = part->Name();
      const auto value = [&](const char* name) { return word_of(*part, name); };
      if (kind == "group") add(value("name"));
      if (kind == "link") links.insert(value("name"));
      if (kind == "joint" || kind == "passive_joint") {
        if (const auto joint = model_.getJoint(value("name"))) links.insert(joint->child_link_name);
      }
      if (kind == "chain") add_between(value("base_link"), value("tip_link"));
    }
  }

  std::set<std::string> links;

 private:
  /// From the root down to a link.
  std::vector<std::string> way_to(const std::string& name) const {
    std::vector<std::string> way;
    for (urdf::LinkConstSharedPtr link = model_.getLink(name); link; link = link->getParent())
      way.insert(way.begin(), link->name);
    return way;
  }

  /// What the ways to both ends do not share.
  void add_between(const std::string& base, const std::string& tip) {
    const std::vector<std::string> first = way_to(base), second = way_to(tip);
    const auto [a, b] = std::mismatch(first.begin(), first.end(), second.begin(), second.end());
    links.insert(a, first.end());
    links.insert(b, second.end());
  }

  const Robot& robot_;
  const urdf::ModelInterface& model_;
  const tinyxml2::XMLElement& root_;
  std::set<std::string> visited_;
};

}  // namespace

std::string word_of(const tinyxml2::XMLElement& element, const char* name) {
  const std::string given = element.Attribute(name) ? element.Attribute(name) : "";
  const std::size_t begin = std::min(given.find_first_not_of(" \t\r\n"), given.size());
  return given.substr(begin, given.find_last_not_of(" \t\r\n") + 1 - begin);
}

std::set<std::string> group_of_file(const Robot& robot, const urdf::ModelInterface& model) {
  const std::string text = read_text(robot.srdf);
  tinyxml2::XMLDocument xml;
  xml.Parse(text.data(), text.size());
  const tinyxml2::XMLElement* root = xml.FirstChildElement("robot");
  if (xml.Error() || !root) disagree(robot, robot.srdf.string() + " is no robot's XML");
  GroupLinks group(robot, model, *root);
  group.add(robot.group);
  std::set<std::string> joints;
  for (const std::string& name : group.links) {
    const auto link = model.getLink(name);
    const auto joint = link ? link->parent_joint : nullptr;
    if (joint && joint->type != urdf::Joint::FIXED && !joint->mimic) joints.insert(joint->name);
  }
  for (const auto* passive = root->FirstChildElement("passive_joint"); passive;
       passive = passive->NextSiblingElement("passive_joint"))
    joints.erase(word_of(*passive, "name"));
  return joints;
}

}  // namespace clearway::check
