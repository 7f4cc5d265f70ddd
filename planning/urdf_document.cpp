#include "planning/urdf_document.hpp"

#include <tinyxml2.h>

#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>

#include "mapping/input_file.hpp"

namespace clearway {
namespace {

using Element = tinyxml2::XMLElement;

constexpr std::size_t most_joints = 500;  ///< a longer chain is no robot, and urdfdom walks it recursively

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw std::invalid_argument(file.string() + ": " + what);
}

/// The numbers of an attribute, separated by blanks.
std::vector<double> numbers(const std::filesystem::path& file, const std::string& where,
                            const Element& element, const char* attribute, std::size_t count) {
  const char* text = element.Attribute(attribute);
  const std::string wanted = where + ": <" + element.Name() + "> needs " + attribute + " with " +
                             std::to_string(count) + " finite number" + (count > 1 ? "s" : "");
  if (!text) refuse(file, wanted);
  std::vector<double> values;
  const char* end = text + std::char_traits<char>::length(text);
  for (const char* at = text; at != end;) {
    if (std::isspace(static_cast<unsigned char>(*at))) {
      ++at;
      continue;
    }
    if (*at == '+') ++at;
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || !std::isfinite(value)) refuse(file, wanted + ", got '" + text + "'");
    values.push_back(value);
    at = next;
  }
  if (values.size() != count) refuse(file, wanted + ", got '" + std::string(text) + "'");
  return values;
}

void check_sizes(const std::filesystem::path& file, const std::string& where, const Element& shape,
                 const char* attribute, std::size_t count, bool may_be_zero = false) {
  for (double value : numbers(file, where, shape, attribute, count)) {
    if (value > 0.0 || (may_be_zero && value == 0.0)) continue;
    refuse(file, where + ": <" + shape.Name() + "> has " + attribute + " '" + shape.Attribute(attribute) +
                     "', expected sizes above 0");
  }
}

/// Checks one <collision>; turns <capsule> into <cylinder> and says whether it did.
bool check_collision(const std::filesystem::path& file, const std::string& where, Element& collision) {
  if (const Element* origin = collision.FirstChildElement("origin")) {
    if (origin->Attribute("xyz")) numbers(file, where, *origin, "xyz", 3);
    if (origin->Attribute("rpy")) numbers(file, where, *origin, "rpy", 3);
  }
  Element* geometry = collision.FirstChildElement("geometry");
  Element* shape = geometry ? geometry->FirstChildElement() : nullptr;
  if (!shape) refuse(file, where + ": <collision> has no <geometry> with a shape in it");
  const std::string kind = shape->Name();
  if (kind == "box") {
    check_sizes(file, where, *shape, "size", 3);
  } else if (kind == "sphere") {
    check_sizes(file, where, *shape, "radius", 1);
  } else if (kind == "cylinder" || kind == "capsule") {
    check_sizes(file, where, *shape, "radius", 1);
    check_sizes(file, where, *shape, "length", 1, kind == "capsule");
  } else if (kind == "mesh") {
    if (!shape->Attribute("filename")) refuse(file, where + ": <mesh> has no filename");
    if (shape->Attribute("scale")) numbers(file, where, *shape, "scale", 3);
  } else {
    refuse(file, where + ": unknown collision shape <" + kind +
                     ">, expected box, sphere, cylinder, capsule or mesh");
  }
  if (kind != "capsule") return false;
  shape->SetName("cylinder");
  return true;
}

/// The attribute of a child element, or a refusal.
std::string child_attribute(const std::filesystem::path& file, const std::string& where,
                            const Element& element, const char* child, const char* attribute) {
  const Element* found = element.FirstChildElement(child);
  const char* value = found ? found->Attribute(attribute) : nullptr;
  if (!value) refuse(file, where + ": <" + child + " " + attribute + "=…> is missing");
  return value;
}

void check_joint(const std::filesystem::path& file, const std::string& where, const Element& joint) {
  const std::string type = joint.Attribute("type") ? joint.Attribute("type") : "";
  if (type != "fixed" && type != "revolute" && type != "continuous" && type != "prismatic") {
    refuse(file, where + ": type '" + type +
                     "' is not supported, expected revolute, continuous, prismatic or fixed");
  }
  if (const Element* origin = joint.FirstChildElement("origin")) {
    if (origin->Attribute("xyz")) numbers(file, where, *origin, "xyz", 3);
    if (origin->Attribute("rpy")) numbers(file, where, *origin, "rpy", 3);
  }
  if (type == "fixed") return;
  if (const Element* axis = joint.FirstChildElement("axis"); axis && axis->Attribute("xyz")) {
    const std::vector<double> a = numbers(file, where, *axis, "xyz", 3);
    if (std::hypot(a[0], a[1], a[2]) < 1e-9) refuse(file, where + ": the axis is zero, expected a direction");
  }
  if (type == "continuous") return;
  const Element* limit = joint.FirstChildElement("limit");
  if (!limit) refuse(file, where + ": a " + type + " joint needs <limit lower=… upper=…>");
  const double lower = limit->Attribute("lower") ? numbers(file, where, *limit, "lower", 1)[0] : 0.0;
  const double upper = limit->Attribute("upper") ? numbers(file, where, *limit, "upper", 1)[0] : 0.0;
  if (lower > upper) refuse(file, where + ": the lower limit is above the upper limit");
}

/// Every link but one hangs on exactly one joint, and no joints form a loop.
void check_tree(const std::filesystem::path& file, const std::set<std::string>& links,
                const std::map<std::string, std::string>& parent_of) {
  std::string root;
  for (const std::string& link : links) {
    if (parent_of.contains(link)) continue;
    if (!root.empty()) {
      refuse(file, "links '" + root + "' and '" + link + "' both have no parent joint, expected one root");
    }
    root = link;
  }
  for (const std::string& link : links) {
    std::string at = link;
    for (std::size_t steps = 0; parent_of.contains(at); ++steps) {
      if (steps > links.size())
        refuse(file, "the joints above link '" + link + "' form a loop, expected a tree");
      at = parent_of.at(at);
    }
  }
}

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  return read_input(file, "robot file", 16U << 20U);
}

UrdfDocument read_urdf_document(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  tinyxml2::XMLDocument xml;
  if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    refuse(file, "is not well-formed XML, line " + std::to_string(xml.ErrorLineNum()));
  }
  Element* robot = xml.FirstChildElement("robot");
  if (!robot) refuse(file, "is not a URDF: it has no <robot> element");

  UrdfDocument document;
  std::set<std::string> links;
  for (Element* link = robot->FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    const std::string name = link->Attribute("name") ? link->Attribute("name") : "";
    if (name.empty()) refuse(file, "a <link> has no name");
    if (!links.insert(name).second) refuse(file, "link '" + name + "' is defined twice");
    std::vector<bool>& is_capsule = document.is_capsule[name];
    for (Element* body = link->FirstChildElement("collision"); body;
         body = body->NextSiblingElement("collision")) {
      is_capsule.push_back(check_collision(file, "link '" + name + "'", *body));
    }
  }
  std::map<std::string, std::string> parent_of;
  std::set<std::string> joints;
  for (const Element* joint = robot->FirstChildElement("joint"); joint;
       joint = joint->NextSiblingElement("joint")) {
    const std::string name = joint->Attribute("name") ? joint->Attribute("name") : "";
    if (name.empty()) refuse(file, "a <joint> has no name");
    if (!joints.insert(name).second) refuse(file, "joint '" + name + "' is defined twice");
    const std::string where = "joint '" + name + "'";
    check_joint(file, where, *joint);
    const std::string parent = child_attribute(file, where, *joint, "parent", "link");
    const std::string child = child_attribute(file, where, *joint, "child", "link");
    for (const std::string& end : {parent, child}) {
      if (!links.contains(end)) refuse(file, where + ": there is no link '" + end + "'");
    }
    if (!parent_of.emplace(child, parent).second) {
      refuse(file, where + ": link '" + child + "' already has a parent joint, expected a tree");
    }
    document.joint_order.push_back(name);
    if (document.joint_order.size() > most_joints) refuse(file, "has more than 500 joints");
  }
  if (links.empty()) refuse(file, "has no links");
  check_tree(file, links, parent_of);

  tinyxml2::XMLPrinter printer;
  xml.Print(&printer);
  document.text = printer.CStr();
  return document;
}

}  // namespace clearway
