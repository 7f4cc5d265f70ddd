#include "planning/robot_files/urdf_document.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/urdf_elements.hpp"
#include "planning/robot_files/urdf_numbers.hpp"
#include "planning/robot_files/urdf_spelling.hpp"
#include "planning/robot_files/xacro_file.hpp"

namespace clearway {
namespace {

using Element = tinyxml2::XMLElement;
using Place = UrdfPlace;

constexpr std::size_t most_joints = 500;  ///< a longer chain is no robot, and urdfdom walks it recursively
constexpr std::size_t most_bytes_of_robot = 16U << 20U;
constexpr std::size_t most_bodies = 1000;

/// The attribute of a child element, or a refusal.
std::string child_attribute(const Place& place, const Element& element, const char* child,
                            const char* attribute) {
  const Element* found = element.FirstChildElement(child);
  const char* value = found ? found->Attribute(attribute) : nullptr;
  if (!value) place.refuse(std::string("<") + child + " " + attribute + "=…> is missing");
  return value;
}

/// Every link but one hangs on exactly one joint, and no joints form a loop.
void check_tree(const Place& place, const std::set<std::string>& links,
                const std::map<std::string, std::string>& parent_of) {
  std::string root;
  for (const std::string& link : links) {
    if (parent_of.contains(link)) continue;
    if (!root.empty()) {
      place.refuse("links " + quote(root) + " and " + quote(link) +
                   " both have no parent joint, expected one root");
    }
    root = link;
  }
  for (const std::string& link : links) {
    std::string at = link;
    for (std::size_t steps = 0; parent_of.contains(at); ++steps) {
      if (steps > links.size())
        place.refuse("the joints above link " + quote(link) + " form a loop, expected a tree");
      at = parent_of.at(at);
    }
  }
}

/// What xacro has yet to fill in is missing from the robot; its definitions alone do no harm.
void check_is_expanded(const Place& place, const Element& robot) {
  for (const Element* child = robot.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string_view name = child->Name();
    if (!name.starts_with("xacro:") || name == "xacro:property" || name == "xacro:arg" ||
        name == "xacro:macro")
      continue;
    place.refuse("holds <" + shortened(name) + ">, expected a URDF that xacro has expanded");
  }
}

std::string name_of(const Place& place, const Element& element) {
  const char* name = element.Attribute("name");
  if (!name || !*name) place.refuse(std::string("a <") + element.Name() + "> has no name");
  return name;
}

std::set<std::string> check_links(const Place& place, Element& robot, UrdfDocument& document) {
  std::set<std::string> links;
  std::size_t bodies = 0;
  for (Element* link = robot.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    const std::string name = name_of(place, *link);
    if (!links.insert(name).second) place.refuse("link " + quote(name) + " is defined twice");
    const Place here{place.file, "link " + quote(name)};
    check_urdf_element(here, *link);
    if (const Element* inertial = link->FirstChildElement("inertial")) check_urdf_inertial(here, *inertial);
    std::vector<bool>& is_capsule = document.is_capsule[name];
    for (Element* body = link->FirstChildElement("collision"); body;
         body = body->NextSiblingElement("collision")) {
      if (++bodies > most_bodies) place.refuse("has more than 1000 <collision> bodies");
      is_capsule.push_back(check_urdf_collision(here, *body));
    }
    if (is_capsule.empty() && link->FirstChildElement("visual")) document.only_seen.push_back(name);
    keep_urdf_children(*link, {"inertial", "collision"});
  }
  if (links.empty()) place.refuse("has no links");
  return links;
}

/// The links that stand where the root does, itself included: fixed joints alone lead to them, or such that
/// let a base float or drive. Known before the joints are looked at one by one.
class StandingLinks {
 public:
  explicit StandingLinks(const Element& robot) {
    for (const Element* joint = robot.FirstChildElement("joint"); joint;
         joint = joint->NextSiblingElement("joint")) {
      const Element *parent = joint->FirstChildElement("parent"), *child = joint->FirstChildElement("child");
      if (!parent || !child || !parent->Attribute("link") || !child->Attribute("link")) continue;
      const bool stands = joint->Attribute("type", "fixed") || is_base_joint(*joint);
      above_[child->Attribute("link")] = {parent->Attribute("link"), stands};
    }
  }

  bool contains(const std::string& link) const {
    std::string at = link;
    for (std::size_t steps = 0; steps <= above_.size(); ++steps) {
      const auto joint = above_.find(at);
      if (joint == above_.end()) return true;
      if (!joint->second.stands) return false;
      at = joint->second.parent;
    }
    return false;  // a loop
  }

 private:
  struct Above {
    std::string parent;
    bool stands = false;
  };
  std::map<std::string, Above> above_;  ///< the joint above a link
};

/// The lesser of acceleration and deceleration, which no planner of ours tells apart. As of velocities, what
/// is not above 0 says nothing, nor does a limit that no robot reaches.
UrdfDocument::Changes changes_of(const Place& place, const Element& joint) {
  const Element* limit = joint.FirstChildElement("limit");
  const auto value = [&](const char* name) {
    const double given =
        limit && limit->Attribute(name) ? urdf_numbers(place, *limit, name, 1, urdf_any)[0] : 0.0;
    return given >= 1e-9 && given <= 1e9 ? given : 0.0;
  };
  const double speeding = value("acceleration"), braking = value("deceleration");
  return {speeding > 0.0 && braking > 0.0 ? std::min(speeding, braking) : std::max(speeding, braking),
          value("jerk")};
}

void check_joints(const Place& place, Element& robot, const std::set<std::string>& links,
                  UrdfDocument& document) {
  const StandingLinks standing(robot);
  std::map<std::string, std::string> parent_of;
  std::set<std::string> joints;
  for (Element* joint = robot.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    const std::string name = name_of(place, *joint);
    if (!joints.insert(name).second) place.refuse("joint " + quote(name) + " is defined twice");
    const Place here{place.file, "joint " + quote(name)};
    check_urdf_element(here, *joint);
    const std::string parent = child_attribute(here, *joint, "parent", "link");
    check_urdf_joint(here, *joint, standing.contains(parent));
    const std::string child = child_attribute(here, *joint, "child", "link");
    for (const std::string& end : {parent, child}) {
      if (!links.contains(end)) here.refuse("there is no link " + quote(end));
    }
    if (!parent_of.emplace(child, parent).second)
      here.refuse("link " + quote(child) + " already has a parent joint, expected a tree");
    document.joint_order.push_back(name);
    document.changes[name] = changes_of(here, *joint);
    if (document.joint_order.size() > most_joints) place.refuse("has more than 500 joints");
  }
  check_tree(place, links, parent_of);
}

/// xacro of 2012 wrote its notice first and <?xml …?> below it, where XML does not have it.
void blank_late_declaration(std::string& text) {
  constexpr const char* blanks = " \t\r\n";
  std::size_t at = text.find_first_not_of(blanks);
  while (at != std::string::npos && text.compare(at, 4, "<!--") == 0) {
    const std::size_t end = text.find("-->", at + 4);
    at = end == std::string::npos ? end : text.find_first_not_of(blanks, end + 3);
  }
  if (at == std::string::npos || text.compare(at, 6, "<?xml ") != 0) return;
  const std::size_t end = std::min(text.find("?>", at), text.size() - 2) + 2;
  for (; at < end; ++at)
    if (text[at] != '\n') text[at] = ' ';
}

/// Line ends and tabs in attributes are blanks to a reader of XML (3.3.3 of the standard), but not to
/// tinyxml2; urdfdom parts numbers at blanks alone.
void blank_within_attributes(std::string& text) {
  char closing = '\0';  // the quotation mark of the attribute that `at` is in
  bool is_tag = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (closing != '\0') {
      if (c == closing) closing = '\0';
      if (c == '\t' || c == '\n' || c == '\r') text[at] = ' ';
    } else if (!is_tag && text.compare(at, 4, "<!--") == 0) {
      at = std::min(text.find("-->", at + 4), text.size() - 1);
    } else if (!is_tag && text.compare(at, 9, "<![CDATA[") == 0) {
      at = std::min(text.find("]]>", at), text.size() - 1);
    } else if (is_tag && (c == '"' || c == '\'')) {
      closing = c;
    } else if (c == '<' || c == '>') {
      is_tag = c == '<';
    }
  }
}

}  // namespace

std::string read_text(const std::filesystem::path& file, const XacroArguments& arguments) {
  std::string text = read_input(file, "robot file", most_bytes_of_robot);
  if (extension_of(file) == ".xacro") text = expanded_xacro(file, most_bytes_of_robot, arguments);
  blank_late_declaration(text);
  // What is not well-formed stays as it is: errors name its lines.
  std::string blanked = text;
  blank_within_attributes(blanked);
  if (blanked == text) return text;
  tinyxml2::XMLDocument xml;
  return xml.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS ? blanked : text;
}

UrdfDocument read_urdf_document(const std::filesystem::path& file, const XacroArguments& arguments) {
  const std::string text = read_text(file, arguments);
  const Place place{file, ""};
  tinyxml2::XMLDocument xml;
  if (const auto error = xml.Parse(text.data(), text.size()); error == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED) {
    place.refuse("nests its elements too deeply for a URDF");
  } else if (error != tinyxml2::XML_SUCCESS) {
    place.refuse("is not well-formed XML, line " + std::to_string(xml.ErrorLineNum()));
  }
  Element* robot = xml.FirstChildElement("robot");
  if (!robot) place.refuse("is not a URDF: it has no <robot> element");
  if (!robot->Attribute("name")) place.refuse("<robot> has no name");
  robot->DeleteAttribute("version");  // urdfdom 3.0 knows 1.0 alone; what later ones add is looked at here
  check_urdf_root(place, *robot);
  check_is_expanded(place, *robot);

  UrdfDocument document;
  const std::set<std::string> links = check_links(place, *robot, document);
  check_joints(place, *robot, links, document);
  keep_urdf_children(*robot, {"link", "joint"});
  tinyxml2::XMLPrinter printer;
  xml.Print(&printer);
  document.text = printer.CStr();
  return document;
}

}  // namespace clearway
