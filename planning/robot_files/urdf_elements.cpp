#include "planning/robot_files/urdf_elements.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Element = tinyxml2::XMLElement;
using Place = UrdfPlace;

constexpr double no_limit = -1.0;                     ///< of a speed, as Gazebo and its converters write it
constexpr double least_axis = 1e-3, most_axis = 1e3;  ///< length, before it is made 1

void check_sizes(const Place& place, const Element& shape, const char* attribute, std::size_t count,
                 bool may_be_zero = false) {
  for (double value : urdf_numbers(place, shape, attribute, count, urdf_any)) {
    if (value > 0.0 || (may_be_zero && value == 0.0)) continue;
    place.refuse(std::string("<") + shape.Name() + "> has " + attribute + " " +
                 quote(shape.Attribute(attribute)) + ", expected sizes above 0");
  }
  if (!may_be_zero) urdf_numbers(place, shape, attribute, count, urdf_size);
  if (may_be_zero) urdf_numbers(place, shape, attribute, count, {0.0, urdf_size.most, urdf_size.unit});
}

void check_scale(const Place& place, const Element& mesh) {
  if (!mesh.Attribute("scale")) return;
  for (double factor : urdf_numbers(place, mesh, "scale", 3, {-1e6, 1e6, "factors"})) {
    if (std::abs(factor) >= 1e-6) continue;
    place.refuse("<mesh> has scale " + quote(mesh.Attribute("scale")) +
                 ", expected factors of at least 0.000001, or as far below 0");
  }
}

/// urdfdom takes an <axis> without xyz for one of no length, and one of 1e200 becomes that when it is
/// normalised: in both cases the joint would stand still.
void check_axis(const Place& place, const Element& joint) {
  const Element* axis = joint.FirstChildElement("axis");
  if (!axis) return;
  const std::vector<double> a = urdf_numbers(place, *axis, "xyz", 3, urdf_any);
  const double length = std::hypot(a[0], a[1], a[2]);
  if (length == 0.0) place.refuse("the axis is zero, expected a direction");
  if (length >= least_axis && length <= most_axis) return;
  place.refuse("<axis> has xyz " + quote(axis->Attribute("xyz")) +
               ", expected a direction of length 1, at least 0.001 and at most 1000");
}

/// Gazebo and its converters write limits of 1e16 for a joint that turns without end.
bool turns_without_end(const Place& place, const Element& joint, const std::string& type) {
  const Element* limit = joint.FirstChildElement("limit");
  if (type != "revolute" || !limit || !limit->Attribute("lower") || !limit->Attribute("upper")) return false;
  return urdf_numbers(place, *limit, "lower", 1, urdf_any)[0] < urdf_turns.least &&
         urdf_numbers(place, *limit, "upper", 1, urdf_any)[0] > urdf_turns.most;
}

void check_limit(const Place& place, const Element& joint, const std::string& type) {
  const Element* limit = joint.FirstChildElement("limit");
  const bool is_limited = type != "continuous";
  if (is_limited && !(limit && (limit->Attribute("lower") || limit->Attribute("upper"))))
    place.refuse("a " + type + " joint needs <limit lower=… upper=…>");
  if (!limit) return;
  for (const char* name : {"effort", "velocity"})  // urdfdom reads no joint without
    if (!limit->Attribute(name))
      place.refuse(std::string("<limit> needs ") + name +
                   " with 1 finite number, 0 where there is none to keep");
  urdf_numbers(place, *limit, "effort", 1, urdf_any);
  const bool is_unknown = urdf_numbers(place, *limit, "velocity", 1, urdf_any)[0] == no_limit;
  if (!is_unknown) urdf_numbers(place, *limit, "velocity", 1, urdf_speed);
  for (const char* change : {"acceleration", "deceleration", "jerk"})
    if (limit->Attribute(change)) urdf_numbers(place, *limit, change, 1, urdf_any);
  const UrdfRange range = type == "prismatic" ? urdf_metres : is_limited ? urdf_turns : urdf_any;
  const auto bound = [&](const char* name) {  // URDF: 0 where only the other one is given
    return limit->Attribute(name) ? urdf_numbers(place, *limit, name, 1, range)[0] : 0.0;
  };
  const double lower = bound("lower"), upper = bound("upper");
  if (is_limited && lower > upper) place.refuse("the lower limit is above the upper limit");
}

/// Limits that keep the joint's soft ones too, as MoveIt reads them; two zeros, which exporters write, say
/// nothing. urdfdom makes 0 of one that is missing.
void keep_soft_limits(const Place& place, Element& joint, std::string& type) {
  const Element* soft = joint.FirstChildElement("safety_controller");
  if (!soft) return;
  const char* names[] = {"soft_lower_limit", "soft_upper_limit"};
  const bool has_lower = soft->Attribute(names[0]), has_upper = soft->Attribute(names[1]);
  if (!has_lower && !has_upper) return;
  if (has_lower != has_upper)
    place.refuse(std::string("<safety_controller> has ") + names[has_lower ? 0 : 1] + " alone, expected " +
                 names[0] + " and " + names[1]);
  const auto any = [&](int i) { return urdf_numbers(place, *soft, names[i], 1, urdf_any)[0]; };
  if (type != "prismatic" && any(0) < urdf_turns.least && any(1) > urdf_turns.most) return;  // none, as 1e16
  const UrdfRange range = type == "prismatic" ? urdf_metres : urdf_turns;
  const double lower = urdf_numbers(place, *soft, names[0], 1, range)[0];
  const double upper = urdf_numbers(place, *soft, names[1], 1, range)[0];
  if (lower == 0.0 && upper == 0.0) return;
  if (lower > upper) place.refuse("the soft lower limit is above the soft upper limit");
  Element* limit = joint.FirstChildElement("limit");
  if (type == "continuous") {
    type = "revolute";
    joint.SetAttribute("type", type.c_str());
    if (!limit) limit = joint.InsertNewChildElement("limit");
    for (const char* name : {"effort", "velocity"})
      if (!limit->Attribute(name)) limit->SetAttribute(name, "-1");
    limit->SetAttribute("lower", soft->Attribute(names[0]));
    limit->SetAttribute("upper", soft->Attribute(names[1]));
    return;
  }
  const auto hard = [&](const char* name) {
    return limit->Attribute(name) ? urdf_numbers(place, *limit, name, 1, range)[0] : 0.0;
  };
  const double hard_lower = hard("lower"), hard_upper = hard("upper");
  if (lower > hard_upper || upper < hard_lower)
    place.refuse("no value is within its limits and its soft limits");
  if (lower > hard_lower) limit->SetAttribute("lower", soft->Attribute(names[0]));
  if (upper < hard_upper) limit->SetAttribute("upper", soft->Attribute(names[1]));
}

/// Whether of a joint and the one of that name one slides and the other turns.
bool is_of_other_kind(const Element& joint, const std::string& name) {
  const Element* other = joint.Parent()->FirstChildElement("joint");
  while (other && !other->Attribute("name", name.c_str())) other = other->NextSiblingElement("joint");
  return other && !other->Attribute("type", "prismatic") != !joint.Attribute("type", "prismatic");
}

void check_mimic(const Place& place, const Element& joint, const UrdfRange& range) {
  const Element* mimic = joint.FirstChildElement("mimic");
  if (!mimic) return;
  if (!mimic->Attribute("joint")) place.refuse("<mimic joint=…> is missing");
  if (mimic->Attribute("offset")) urdf_numbers(place, *mimic, "offset", 1, range);
  if (!mimic->Attribute("multiplier")) return;
  const bool is_geared = is_of_other_kind(joint, mimic->Attribute("joint"));  // m per rad, or rad per m
  const double most = is_geared ? 1e6 : 1e3;
  if (std::abs(urdf_numbers(place, *mimic, "multiplier", 1, {-most, most, "factors"})[0]) >= 1.0 / most)
    return;
  place.refuse("<mimic> has multiplier " + quote(mimic->Attribute("multiplier")) +
               ", expected a factor of at least " + (is_geared ? "0.000001" : "0.001") +
               ", or as far below 0");
}

}  // namespace

/// Leaves of an element's children only those that are read from here on.
void keep_urdf_children(Element& element, std::initializer_list<std::string_view> names) {
  for (Element* child = element.FirstChildElement(); child;) {
    Element* next = child->NextSiblingElement();
    if (std::find(names.begin(), names.end(), child->Name()) == names.end()) element.DeleteChild(child);
    child = next;
  }
}

bool check_urdf_collision(const Place& place, Element& collision) {
  check_urdf_origin(place, collision);
  Element* geometry = collision.FirstChildElement("geometry");
  Element* shape = geometry ? geometry->FirstChildElement() : nullptr;
  if (!shape) place.refuse("<collision> has no <geometry> with a shape in it");
  const std::string kind = shape->Name();
  if (kind == "box") {
    check_sizes(place, *shape, "size", 3);
  } else if (kind == "sphere") {
    check_sizes(place, *shape, "radius", 1);
  } else if (kind == "cylinder" || kind == "capsule") {
    check_sizes(place, *shape, "radius", 1);
    check_sizes(place, *shape, "length", 1, kind == "capsule");
  } else if (kind == "mesh") {
    if (!shape->Attribute("filename")) place.refuse("<mesh> has no filename");
    check_scale(place, *shape);
  } else {
    place.refuse("unknown collision shape <" + shortened(kind) +
                 ">, expected box, sphere, cylinder, capsule or mesh");
  }
  for (const char* other : {"box", "sphere", "cylinder", "capsule", "mesh"}) {
    if (shape->NextSiblingElement(other)) place.refuse("<geometry> holds two shapes, expected one");
  }
  keep_urdf_children(collision, {"origin", "geometry"});
  if (kind != "capsule") return false;
  shape->SetName("cylinder");
  return true;
}

void check_urdf_inertial(const Place& place, const Element& inertial) {
  check_urdf_origin(place, inertial);
  const Element* mass = inertial.FirstChildElement("mass");
  const Element* inertia = inertial.FirstChildElement("inertia");
  if (!mass || !inertia) place.refuse("<inertial> needs <mass> and <inertia>");
  urdf_numbers(place, *mass, "value", 1, {0.0, 1e6, "kilograms"});
  for (const char* moment : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
    urdf_numbers(place, *inertia, moment, 1, urdf_any);
  }
}

bool is_base_joint(const Element& joint) {
  return joint.Attribute("type", "floating") || joint.Attribute("type", "planar");
}

void check_urdf_joint(const Place& place, Element& joint, bool is_of_base) {
  std::string type = joint.Attribute("type") ? joint.Attribute("type") : "";
  if (is_base_joint(joint)) {
    if (!is_of_base)
      place.refuse(
          "type " + quote(type) +
          " is supported of a base alone, where it stands still: expected no joint above it that moves");
    type = "fixed";
    joint.SetAttribute("type", type.c_str());
  }
  if (type != "fixed" && type != "revolute" && type != "continuous" && type != "prismatic") {
    place.refuse("type " + quote(type) +
                 " is not supported, expected revolute, continuous, prismatic or fixed");
  }
  check_urdf_origin(place, joint);
  if (type == "fixed") return keep_urdf_children(joint, {"origin", "parent", "child"});
  check_axis(place, joint);
  if (turns_without_end(place, joint, type)) {
    type = "continuous";
    joint.SetAttribute("type", type.c_str());
  }
  check_limit(place, joint, type);
  keep_soft_limits(place, joint, type);
  check_mimic(place, joint, type == "prismatic" ? urdf_metres : urdf_turns);
  keep_urdf_children(joint, {"origin", "parent", "child", "axis", "limit", "mimic"});
}

}  // namespace clearway
