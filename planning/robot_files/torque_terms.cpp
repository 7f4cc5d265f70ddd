#include "planning/robot_files/torque_terms.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/robot_files/urdf_document.hpp"
#include "planning/robot_files/urdf_numbers.hpp"

namespace clearway {
namespace {

using tinyxml2::XMLElement;

double number_of(const UrdfPlace& place, const XMLElement& element, const char* attribute) {
  return urdf_numbers(place, element, attribute, 1, urdf_any).front();
}

Eigen::Matrix3d turned(const UrdfPlace& place, const XMLElement& inertial, const Eigen::Matrix3d& inertia) {
  const XMLElement* origin = inertial.FirstChildElement("origin");
  if (!origin || !origin->Attribute("rpy")) return inertia;
  const std::vector<double> rpy = urdf_numbers(place, *origin, "rpy", 3, urdf_radians);
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  return turn * inertia * turn.transpose();
}

Eigen::Matrix3d inertia_of(const UrdfPlace& place, const XMLElement& link) {
  const XMLElement* inertial = link.FirstChildElement("inertial");
  const XMLElement* given = inertial ? inertial->FirstChildElement("inertia") : nullptr;
  if (!given) return Eigen::Matrix3d::Zero();
  const auto value = [&](const char* name) { return number_of(place, *given, name); };
  Eigen::Matrix3d inertia;
  inertia << value("ixx"), value("ixy"), value("ixz"),  //
      value("ixy"), value("iyy"), value("iyz"),         //
      value("ixz"), value("iyz"), value("izz");
  return turned(place, *inertial, inertia);
}

double effort_of(const UrdfPlace& place, const XMLElement& joint) {
  const XMLElement* limit = joint.FirstChildElement("limit");
  return limit && limit->Attribute("effort") ? number_of(place, *limit, "effort") : 0.0;
}

}  // namespace

TorqueTerms torque_terms(const Robot& robot, const JointLoad& load) {
  const auto dof = static_cast<Eigen::Index>(robot.dof());
  TorqueTerms terms{std::vector<Eigen::Matrix3d>(robot.links.size(), Eigen::Matrix3d::Zero()),
                    Eigen::VectorXd::Constant(dof, std::numeric_limits<double>::infinity()), load};
  if (robot.source.empty()) return terms;
  const std::filesystem::path file = urdf_of_robot(robot);
  const std::string text = read_text(file, robot.xacro);
  tinyxml2::XMLDocument xml;
  xml.Parse(text.data(), text.size());
  const XMLElement* root = xml.FirstChildElement("robot");
  if (xml.Error() || !root) UrdfPlace{file, "the file"}.refuse("is no robot's XML");
  const std::vector<bool> moves = moves_mass(robot, load);
  for (const XMLElement* at = root->FirstChildElement(); at; at = at->NextSiblingElement()) {
    const std::string kind = at->Name(), name = at->Attribute("name") ? at->Attribute("name") : "";
    const UrdfPlace place{file, kind + " " + quote(name)};
    for (std::size_t i = 0; kind == "link" && i < robot.links.size(); ++i)
      if (robot.links[i].name == name) terms.inertia[i] = std::pow(robot.scale, 5) * inertia_of(place, *at);
    for (std::size_t j = 0; kind == "joint" && j < robot.dof(); ++j) {
      if (robot.joints[j].name != name || !moves[j]) continue;
      const double effort = effort_of(place, *at);
      const int power = robot.joints[j].kind == JointKind::revolute ? 4 : 3;
      if (effort > 0.0) terms.limits[static_cast<Eigen::Index>(j)] = effort * std::pow(robot.scale, power);
    }
  }
  return terms;
}

}  // namespace clearway
