#include "planning/robot_files/robot_settings.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapping/system/input_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/urdf_document.hpp"
#include "planning/robot_files/urdf_numbers.hpp"
#include "planning/robot_files/xacro_file.hpp"

namespace clearway {
namespace {

constexpr double default_friction = 0.1;
constexpr double default_step_rad = 0.5 * std::numbers::pi / 180.0;
constexpr double default_step_m = 0.01;
constexpr double most_of_joints = 1e9;  ///< of friction, steps, accelerations and jerks
/// No robot is as coarse as a metre, and none is exact: no padding has to be asked for, by --padding 0.
constexpr double least_position_accuracy = 1e-9, most_position_accuracy = 1.0;

/// One mapping of the file; knows where it is, so that refusals can say so.
class Section {
 public:
  Section(const std::filesystem::path& file, std::string path, const YAML::Node& node,
          const std::vector<std::string>& keys)
      : file_(file), path_(std::move(path)), node_(node) {
    if (!node.IsMap()) refuse("", "a mapping of keys to values");
    for (const auto& entry : node) {
      const std::string key = entry.first.as<std::string>("");
      if (keys.empty() || std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      if (path_.empty() && nearest_name(key, keys).empty()) {
        std::error_code error;
        const bool is_beside =
            std::filesystem::exists(std::filesystem::path(file).replace_extension(".urdf"), error);
        throw std::invalid_argument(
            file.string() + ": unknown key " + quote(key) + " of a robot's settings" +
            (is_beside ? ", as which a .yaml beside a URDF of its name is read" : "") + ", " +
            suggestion(key, keys));
      }
      throw std::invalid_argument(file.string() + ": unknown key " + quote(path_ + key) + ", " +
                                  suggestion(key, keys));
    }
  }

  bool has(const std::string& key) const { return static_cast<bool>(node_[key]); }
  YAML::Node node(const std::string& key) const { return node_[key]; }

  std::string text(const std::string& key, const std::string& fallback) const {
    if (!has(key)) return fallback;
    if (!node_[key].IsScalar()) refuse(key, "a text");
    return node_[key].Scalar();
  }

  /// NaN for what is no finite number. Without yaml-cpp, which reads "0.5" as the locale has it.
  static double number_of(const YAML::Node& value) {
    return value.IsScalar() ? decimal_number(value.Scalar()) : std::nan("");
  }

  double number(const std::string& key, const YAML::Node& value, double above) const {
    const double result = number_of(value);
    if (!(result >= above))
      refuse(key, above > 0.0 ? "a finite number above 0" : "a finite number not below 0");
    if (result > most_of_joints) refuse(key, "a number of at most 1000000000");
    return result;
  }

  double any_number(const std::string& key, const YAML::Node& value) const {
    const double result = number_of(value);
    if (std::isnan(result)) refuse(key, "a finite number");
    return result;
  }

  double number(const std::string& key, double fallback, double least, double most,
                const std::string& expected) const {
    if (!has(key)) return fallback;
    const double result = any_number(key, node_[key]);
    if (result < least || result > most) refuse(key, expected);
    return result;
  }

  Eigen::Vector3d vector(const std::string& key, const UrdfRange& range) const {
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    if (!has(key)) return result;
    const YAML::Node list = node_[key];
    if (!list.IsSequence() || list.size() != 3) refuse(key, "three numbers [x, y, z]");
    for (std::size_t i = 0; i < 3; ++i) result[static_cast<Eigen::Index>(i)] = number_of(list[i]);
    if (!result.allFinite()) refuse(key, "three finite numbers");
    if ((result.array() < range.least).any() || (result.array() > range.most).any())
      refuse(key, "three numbers, " + text_of(range));
    return result;
  }

  std::vector<std::string> texts(const std::string& key) const {
    std::vector<std::string> result;
    if (!has(key)) return result;
    if (!node_[key].IsSequence()) refuse(key, "a list of names");
    for (const YAML::Node& entry : node_[key]) {
      if (!entry.IsScalar()) refuse(key, "a list of names");
      result.push_back(entry.Scalar());
    }
    return result;
  }

  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const {
    const std::string where = path_ + key;
    throw std::invalid_argument(file_.string() + ": " + (where.empty() ? "the file" : quote(where)) +
                                " must be " + expected);
  }

 private:
  const std::filesystem::path& file_;
  std::string path_;
  YAML::Node node_;
};

Eigen::Isometry3d placement(const Section& section) {
  const Eigen::Vector3d rpy = section.vector("rpy", urdf_radians);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = section.vector("xyz", urdf_metres);
  return pose;
}

PerJoint per_joint(const std::filesystem::path& file, const Section& section, const std::string& key,
                   double above) {
  PerJoint result;
  if (!section.has(key)) return result;
  if (section.node(key).IsScalar()) {
    result.all = section.number(key, section.node(key), above);
    return result;
  }
  if (!section.node(key).IsMap()) section.refuse(key, "a number, or {joint: number}");
  const Section joints(file, key + ".", section.node(key), {});
  for (const auto& entry : section.node(key)) {
    const std::string joint = entry.first.as<std::string>("");
    result.by_name[joint] = joints.number(joint, entry.second, above);
  }
  return result;
}

MeshPieces mesh_pieces_of(const std::filesystem::path& file, const Section& section) {
  const PerJoint given = per_joint(file, section, "mesh_pieces", 1.0);
  const auto whole = [&](double number) {
    if (number != std::round(number) || number > 64.0)
      section.refuse("mesh_pieces", "whole numbers from 1 to 64");
    return static_cast<std::size_t>(number);
  };
  MeshPieces pieces{given.all ? whole(*given.all) : 1};
  for (const auto& [link, number] : given.by_name) pieces.of_link[link] = whole(number);
  return pieces;
}

std::map<std::string, std::string> xacro_of(const std::filesystem::path& file, const YAML::Node& node) {
  const Section section(file, "xacro.", node, {});
  std::map<std::string, std::string> arguments;
  for (const auto& entry : node) {
    const std::string name = entry.first.as<std::string>("");
    if (!is_xacro_name(name)) section.refuse(name, "named by letters, digits and underscores");
    arguments[name] = section.text(name, "");
  }
  return arguments;
}

RobotSettings settings_of(const std::filesystem::path& file, const YAML::Node& root) {
  const Section section(file, "", root,
                        {"description", "urdf", "scale", "base", "tip", "critical_parts", "friction", "step",
                         "max_acceleration", "max_jerk", "position_accuracy", "inverse_kinematics", "exempt",
                         "srdf", "group", "fixed", "standing", "xacro", "mesh_pieces"});
  RobotSettings settings;
  settings.description = section.text("description", "");
  settings.urdf = section.text("urdf", "");
  settings.scale = section.number("scale", 1.0, least_scale, most_scale, "a factor from 0.000001 to 1000");
  if (section.has("base")) {
    settings.map_from_base = placement(Section(file, "base.", section.node("base"), {"xyz", "rpy"}));
  }
  if (section.has("tip")) {
    const Section tip(file, "tip.", section.node("tip"), {"link", "xyz", "rpy"});
    settings.tip_link = tip.text("link", "");
    settings.link_from_tip = placement(tip);
  }
  settings.critical_parts = section.texts("critical_parts");
  settings.friction = per_joint(file, section, "friction", 0.0);
  settings.step = per_joint(file, section, "step", 1e-12);
  settings.max_acceleration = per_joint(file, section, "max_acceleration", 1e-9);
  settings.max_jerk = per_joint(file, section, "max_jerk", 1e-9);
  settings.position_accuracy =
      section.number("position_accuracy", settings.position_accuracy, least_position_accuracy,
                     most_position_accuracy, "a length above 0 and of at most 1 (metres)");
  settings.inverse_kinematics = section.text("inverse_kinematics", "numeric");
  if (settings.inverse_kinematics != "numeric" && settings.inverse_kinematics != "puma") {
    section.refuse("inverse_kinematics", "numeric or puma");
  }
  if (section.has("exempt")) {
    if (!section.node("exempt").IsSequence()) section.refuse("exempt", "a list of pairs of parts");
    settings.exempt.emplace();
    for (const YAML::Node& pair : section.node("exempt")) {
      if (!pair.IsSequence() || pair.size() != 2) section.refuse("exempt", "a list of pairs of parts");
      settings.exempt->emplace_back(pair[0].as<std::string>(""), pair[1].as<std::string>(""));
    }
  }
  settings.srdf = section.text("srdf", "");
  settings.group = section.text("group", "");
  if (section.has("fixed")) {
    const Section fixed(file, "fixed.", section.node("fixed"), {});
    for (const auto& entry : section.node("fixed")) {
      const std::string joint = entry.first.as<std::string>("");
      settings.fixed[joint] = fixed.any_number(joint, entry.second);
    }
  }
  if (section.has("standing")) {
    const YAML::Node list = section.node("standing");
    if (!list.IsSequence()) section.refuse("standing", "a list of links");
    for (const YAML::Node& link : list) settings.standing.push_back(link.as<std::string>(""));
  }
  if (section.has("mesh_pieces")) settings.mesh_pieces = mesh_pieces_of(file, section);
  if (section.has("xacro")) settings.xacro = xacro_of(file, section.node("xacro"));
  return settings;
}

}  // namespace

RobotSettings read_robot_settings(const std::filesystem::path& file) {
  constexpr std::size_t largest = 256U << 10U;  // yaml-cpp takes some hundred bytes for each of its words
  const std::string text = read_input(file, "robot settings", largest);
  try {
    const YAML::Node settings = YAML::Load(text);
    YAML::LoadAll(text + "\n---\n");  // a quoted text ends with the file for yaml-cpp, but may not hold this
    return settings_of(file, settings);
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(
        file.string() + " is not valid YAML at line " + std::to_string(error.mark.line + 1) + ", column " +
        std::to_string(error.mark.column + 1) + ": expected keys and values, lists or texts");
  }
}

bool is_urdf_name(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return kind == ".urdf" || kind == ".xacro";
}

std::filesystem::path beside_urdf(const std::filesystem::path& urdf, const std::string& extension) {
  std::filesystem::path file = urdf;
  if (extension_of(file) == ".xacro") file.replace_extension();
  return file.replace_extension(extension);
}

std::filesystem::path urdf_of(const std::filesystem::path& file, const RobotSettings& settings) {
  if (is_urdf_name(file)) return file;
  if (!settings.urdf.empty()) return file.parent_path() / settings.urdf;
  return std::filesystem::path(file).replace_extension(".urdf");
}

std::filesystem::path urdf_of_robot(const Robot& robot) {
  return urdf_of(robot.source,
                 is_urdf_name(robot.source) ? RobotSettings{} : read_robot_settings(robot.source));
}

void apply_settings(const RobotSettings& settings, const std::filesystem::path& file, Robot& robot) {
  const auto refuse = [&](const std::string& key, const std::string& name) {
    throw std::invalid_argument(file.string() + ": '" + key + "' names " + quote(name) + ", which " +
                                robot.name + " does not have");
  };
  const std::pair<const char*, const PerJoint*> given[] = {{"friction", &settings.friction},
                                                           {"step", &settings.step},
                                                           {"max_acceleration", &settings.max_acceleration},
                                                           {"max_jerk", &settings.max_jerk}};
  for (const auto& [key, values] : given) {
    for (const auto& [name, value] : values->by_name) {
      const bool known = std::any_of(robot.joints.begin(), robot.joints.end(),
                                     [&, joint = name](const Joint& j) { return j.name == joint; });
      if (!known) refuse(key, name);
    }
  }
  const auto chosen = [](const PerJoint& values, const Joint& joint, double fallback) {
    const auto found = values.by_name.find(joint.name);
    return found != values.by_name.end() ? found->second : values.all.value_or(fallback);
  };
  for (Joint& joint : robot.joints) {
    joint.friction = chosen(settings.friction, joint, default_friction);
    joint.step =
        chosen(settings.step, joint, joint.kind == JointKind::revolute ? default_step_rad : default_step_m);
    joint.max_acceleration = chosen(settings.max_acceleration, joint, joint.max_acceleration);
    joint.max_jerk = chosen(settings.max_jerk, joint, joint.max_jerk);
  }
  for (const std::string& part : settings.critical_parts) {
    const bool known =
        std::any_of(robot.bodies.begin(), robot.bodies.end(), [&](const Body& b) { return b.part == part; });
    if (!known) refuse("critical_parts", part);
  }
  robot.critical_parts = settings.critical_parts;
  if (!settings.tip_link.empty()) {
    const auto link = std::find_if(robot.links.begin(), robot.links.end(),
                                   [&](const Link& l) { return l.name == settings.tip_link; });
    if (link == robot.links.end()) refuse("tip.link", settings.tip_link);
    robot.tip_link = static_cast<int>(link - robot.links.begin());
  }
  robot.link_from_tip = settings.link_from_tip;
  robot.map_from_base = settings.map_from_base;
  robot.position_accuracy = settings.position_accuracy;
  robot.inverse_kinematics = settings.inverse_kinematics;
}

}  // namespace clearway
