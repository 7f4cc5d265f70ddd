#include "planning/robot_files/urdf_spelling.hpp"

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <locale>
#include <map>
#include <sstream>
#include <string_view>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Names = std::vector<std::string>;

/// What geometry and kinematics are read from: these may not be misspelt, in what they are found.
struct Vocabulary {
  Names elements, attributes;
};

const std::map<std::string_view, Vocabulary>& vocabulary() {
  static const std::map<std::string_view, Vocabulary> words{
      {"robot", {{"link", "joint"}, {"name"}}},
      {"link", {{"collision", "inertial"}, {"name"}}},
      {"joint",
       {{"origin", "parent", "child", "axis", "limit", "mimic", "safety_controller"}, {"name", "type"}}},
      {"collision", {{"origin", "geometry"}, {}}},
      {"geometry", {{"box", "sphere", "cylinder", "capsule", "mesh"}, {}}},
      {"inertial", {{"origin", "mass", "inertia"}, {}}},
      {"origin", {{}, {"xyz", "rpy"}}},
      {"parent", {{}, {"link"}}},
      {"child", {{}, {"link"}}},
      {"axis", {{}, {"xyz"}}},
      {"limit", {{}, {"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"}}},
      {"safety_controller", {{}, {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"}}},
      {"mimic", {{}, {"joint", "multiplier", "offset"}}},
      {"box", {{}, {"size"}}},
      {"sphere", {{}, {"radius"}}},
      {"cylinder", {{}, {"radius", "length"}}},
      {"capsule", {{}, {"radius", "length"}}},
      {"mesh", {{}, {"filename", "scale"}}},
      {"mass", {{}, {"value"}}},
      {"inertia", {{}, {}}},
  };
  return words;
}

bool are_equal(const tinyxml2::XMLElement& a, const tinyxml2::XMLElement& b) {
  tinyxml2::XMLPrinter print_a(nullptr, true), print_b(nullptr, true);
  a.Accept(&print_a);
  b.Accept(&print_b);
  return std::string_view(print_a.CStr()) == print_b.CStr();
}

/// An attribute near one that is there as well is no slip of it: <limit velocity=… k_velocity=…>.
void check_names(const UrdfPlace& place, const tinyxml2::XMLElement& element, const Vocabulary& known) {
  const auto& [elements, attributes] = known;
  for (const auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string meant = misspelt_name(child->Name(), elements);
    if (meant.empty()) continue;
    place.refuse(std::string("unknown element <") + shortened(child->Name()) + "> in <" + element.Name() +
                 ">, did you mean <" + meant + ">?");
  }
  for (const auto* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next()) {
    const std::string meant = misspelt_name(attribute->Name(), attributes);
    if (meant.empty() || element.Attribute(meant.c_str())) continue;
    place.refuse(std::string("<") + element.Name() + "> has an unknown attribute " +
                 quote(attribute->Name()) + ", did you mean '" + meant + "'?");
  }
}

/// Readers take the first and skip a second one.
void check_given_once(const UrdfPlace& place, const tinyxml2::XMLElement& first) {
  for (const auto* next = &first; (next = next->NextSiblingElement(first.Name()));) {
    if (are_equal(first, *next)) continue;
    place.refuse(std::string("two different <") + first.Name() + ">, expected one");
  }
}

std::vector<double> numbers_in(const char* text) {
  std::istringstream words(text == nullptr ? "" : text);
  words.imbue(std::locale::classic());
  std::vector<double> numbers;
  for (double number = 0.0; words >> number;) numbers.push_back(number);
  return words.eof() ? numbers : std::vector<double>();
}

/// Whether rpy and quat_xyzw say the same turn.
bool is_turn_twice(const tinyxml2::XMLElement& element) {
  const std::vector<double> rpy = numbers_in(element.Attribute("rpy")),
                            xyzw = numbers_in(element.Attribute("quat_xyzw"));
  if (rpy.size() != 3 || xyzw.size() != 4) return false;
  const Eigen::Quaterniond turn(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  const Eigen::Quaterniond same(Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()));
  constexpr double rounding = 1e-3;
  return std::abs(turn.norm() - 1.0) < rounding && turn.normalized().angularDistance(same) < rounding;
}

}  // namespace

void check_urdf_element(const UrdfPlace& place, const tinyxml2::XMLElement& element) {
  const Vocabulary& known = vocabulary().at(element.Name());
  check_names(place, element, known);
  if (element.Attribute("quat_xyzw") && !is_turn_twice(element))
    place.refuse(std::string("<") + element.Name() + "> has quat_xyzw, which is not read, expected rpy" +
                 (element.Attribute("rpy") ? " alone, or both of the same turn" : ""));
  for (const std::string& name : known.elements) {
    const bool once = name != "collision";
    const tinyxml2::XMLElement* child = element.FirstChildElement(name.c_str());
    if (child && once) check_given_once(place, *child);
    for (; child; child = once ? nullptr : child->NextSiblingElement(name.c_str())) {
      check_urdf_element(place, *child);
    }
  }
}

void check_urdf_root(const UrdfPlace& place, const tinyxml2::XMLElement& robot) {
  check_names(place, robot, vocabulary().at("robot"));
}

}  // namespace clearway
