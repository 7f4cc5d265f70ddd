#include <tinyxml2.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <limits>
#include <locale>
#include <sstream>

#include "mapping/files/number_words.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/robot_files/urdf_document.hpp"
#include "planning/robot_files/urdf_messages.hpp"

namespace clearway::check {
namespace {

constexpr std::size_t most_joints = 500;  ///< urdfdom and kdl_parser walk a chain recursively
constexpr double limit_tolerance = 1e-9;  ///< of limits, rad or m
constexpr double endless_turn = 1e3;      ///< beyond both ways (Gazebo writes 1e16) a joint turns without end

/// What else urdfdom reads of a joint (dynamics, calibration) it may refuse, and it moves nothing.
bool is_read_of_joint(const std::string& element, bool is_fixed) {
  if (element == "origin" || element == "parent" || element == "child") return true;
  return !is_fixed && (element == "axis" || element == "limit" || element == "mimic");
}

const char* link_of(const tinyxml2::XMLElement& joint, const char* end) {
  const tinyxml2::XMLElement* const element = joint.FirstChildElement(end);
  const char* const link = element ? element->Attribute("link") : nullptr;
  return link ? link : "";
}

const tinyxml2::XMLElement* joint_above(const tinyxml2::XMLElement& joint) {
  const std::string parent = link_of(joint, "parent");
  const tinyxml2::XMLElement* other = joint.Parent()->FirstChildElement("joint");
  while (other && parent != link_of(*other, "child")) other = other->NextSiblingElement("joint");
  return other;
}

/// Whether a joint lets the base float or drive, and all above it are such or fixed: it stands where the
/// robot has it.
bool is_of_base(const tinyxml2::XMLElement& joint) {
  const auto may_float = [](const tinyxml2::XMLElement& one) {
    return one.Attribute("type", "floating") || one.Attribute("type", "planar");
  };
  if (!may_float(joint)) return false;
  const tinyxml2::XMLElement* above = joint_above(joint);
  for (std::size_t i = 0; above && i < most_joints; ++i) {
    if (!may_float(*above) && !above->Attribute("type", "fixed")) return false;
    above = joint_above(*above);
  }
  return above == nullptr;
}

/// A joint's range as its <safety_controller> narrows it, unless it gives two zeros.
void keep_soft_limits(tinyxml2::XMLElement& joint) {
  tinyxml2::XMLElement* const soft = joint.FirstChildElement("safety_controller");
  if (!soft || joint.Attribute("type", "fixed")) return;
  const auto text_of = [](const tinyxml2::XMLElement& element, const char* name) {
    return element.Attribute(name) ? element.Attribute(name) : "0";
  };
  const char *const low = text_of(*soft, "soft_lower_limit"), *const high =
                                                                  text_of(*soft, "soft_upper_limit");
  const auto value = [](const char* text) { return parsed_number(text).value_or(0.0); };
  if (value(low) == 0.0 && value(high) == 0.0) return;
  if (!joint.Attribute("type", "prismatic") && value(low) < -endless_turn && value(high) > endless_turn)
    return;
  tinyxml2::XMLElement* limit = joint.FirstChildElement("limit");
  if (!limit) {
    limit = joint.InsertNewChildElement("limit");
    limit->SetAttribute("effort", "0");
    limit->SetAttribute("velocity", "0");
  }
  const bool is_endless = joint.Attribute("type", "continuous") != nullptr;
  if (is_endless) joint.SetAttribute("type", "revolute");
  if (is_endless || value(low) > value(text_of(*limit, "lower"))) limit->SetAttribute("lower", low);
  if (is_endless || value(high) < value(text_of(*limit, "upper"))) limit->SetAttribute("upper", high);
}

/// The file's joints and links alone. A body's shape becomes a sphere, of a mesh a box, because urdfdom knows
/// no capsules and drops a body whose shape it does not know; its place stays. Masses go: KDL complains of
/// one at the root.
std::string bare_text(const Robot& robot) {
  const std::string text = read_text(urdf_of_robot(robot), robot.xacro);
  tinyxml2::XMLDocument xml;
  xml.Parse(text.data(), text.size());
  tinyxml2::XMLElement* root = xml.FirstChildElement("robot");
  if (xml.Error() || !root) disagree(robot, "it is no robot's XML");
  root->DeleteAttribute("version");  // urdfdom 3.0 knows 1.0 alone
  std::size_t joints = 0;
  for (auto* element = root->FirstChildElement(); element;) {
    auto* const next = element->NextSiblingElement();
    const std::string name = element->Name();
    if (name == "joint" && is_of_base(*element)) element->SetAttribute("type", "fixed");
    const bool is_fixed = element->Attribute("type", "fixed") != nullptr;
    joints += name == "joint";
    if (name == "joint") keep_soft_limits(*element);
    if (name != "joint" && name != "link") root->DeleteChild(element);
    for (auto* part = name == "link" || name == "joint" ? element->FirstChildElement() : nullptr; part;) {
      auto* const following = part->NextSiblingElement();
      const std::string kind = part->Name();
      if (name == "joint") {
        if (!is_read_of_joint(kind, is_fixed)) element->DeleteChild(part);
      } else if (kind != "collision") {
        element->DeleteChild(part);
      } else if (auto* geometry = part->FirstChildElement("geometry")) {
        const bool is_mesh = geometry->FirstChildElement("mesh") != nullptr;
        geometry->DeleteChildren();
        if (is_mesh)
          geometry->InsertNewChildElement("box")->SetAttribute("size", "1 1 1");
        else
          geometry->InsertNewChildElement("sphere")->SetAttribute("radius", "1");
      }
      part = following;
    }
    element = next;
  }
  if (joints > most_joints) disagree(robot, "it has more than 500 joints");
  tinyxml2::XMLPrinter printer;
  xml.Print(&printer);
  return printer.CStr();
}

/// The file's model with its lengths at the robot's scale.
urdf::ModelInterfaceSharedPtr scaled_model(const Robot& robot) {
  const auto scale = [&](urdf::Vector3& length) {
    length.x *= robot.scale, length.y *= robot.scale, length.z *= robot.scale;
  };
  const std::string text = bare_text(robot);
  const KeptMessages messages;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model || !model->getRoot()) disagree(robot, "urdfdom refuses it: " + messages.first);
  const auto unit = [&](const urdf::Joint& joint) {
    return joint.type == urdf::Joint::PRISMATIC ? robot.scale : 1.0;
  };
  for (auto& [name, joint] : model->joints_) {
    scale(joint->parent_to_joint_origin_transform.position);
    if (joint->limits) joint->limits->lower *= unit(*joint), joint->limits->upper *= unit(*joint);
    if (!joint->mimic) continue;
    const urdf::JointConstSharedPtr master = model->getJoint(joint->mimic->joint_name);
    joint->mimic->offset *= unit(*joint);
    joint->mimic->multiplier *= unit(*joint) / (master ? unit(*master) : 1.0);
  }
  for (auto& [name, link] : model->links_) {
    for (auto& collision : link->collision_array) scale(collision->origin.position);
  }
  return model;
}

Eigen::Isometry3d isometry(const urdf::Pose& pose) {
  Eigen::Quaterniond turn;
  pose.rotation.getQuaternion(turn.x(), turn.y(), turn.z(), turn.w());
  Eigen::Isometry3d result(turn.normalized());
  result.translation() << pose.position.x, pose.position.y, pose.position.z;
  return result;
}

class FileReader {
 public:
  explicit FileReader(const Robot& robot) : robot_(robot), model_(scaled_model(robot)) {
    if (!kdl_parser::treeFromUrdfModel(*model_, tree_)) disagree(robot, "kdl_parser refuses it");
    if (model_->links_.size() != own_links(robot))
      disagree(robot, "it has " + counted(model_->links_.size(), "link") + ", not " +
                          std::to_string(own_links(robot)));
  }

  KdlModel model() {
    for (std::size_t i = 0; i < own_links(robot_); ++i) add_link(robot_.links[i]);
    add_bodies();
    add_loads(robot_, kdl_);
    require_group();
    return std::move(kdl_);
  }

 private:
  void add_link(const Link& link) {
    const auto element = tree_.getSegment(link.name);
    if (element == tree_.getSegments().end()) disagree(robot_, "it has no link " + quote(link.name));
    const bool is_root = element == tree_.getRootSegment();
    kdl_.links.push_back({.segment = std::make_shared<KDL::Segment>(GetTreeElementSegment(element->second)),
                          .parent = is_root ? -1 : index_of(GetTreeElementParent(element->second)->first),
                          .stands = stands(robot_, link.name)});
    const urdf::JointSharedPtr joint = model_->links_.at(link.name)->parent_joint;
    if (joint && joint->type != urdf::Joint::FIXED) add_joint(*joint);
  }

  int index_of(const std::string& link) const {
    for (std::size_t i = 0; i < own_links(robot_); ++i)
      if (robot_.links[i].name == link) return static_cast<int>(i);
    disagree(robot_, "link " + quote(link) + " is none of the robot's");
  }

  /// value of a joint = multiplier * value of `name` + offset, over all that mimic in between.
  struct Followed {
    std::string name;
    double multiplier = 1.0, offset = 0.0;
  };

  Followed followed(const urdf::Joint& joint) const {
    if (!joint.mimic) return {joint.name};
    Followed end{joint.mimic->joint_name, joint.mimic->multiplier, joint.mimic->offset};
    for (std::size_t i = 0; i < most_joints; ++i) {
      const urdf::JointConstSharedPtr next = model_->getJoint(end.name);
      if (!next || !next->mimic) return end;
      end = {next->mimic->joint_name, end.multiplier * next->mimic->multiplier,
             end.multiplier * next->mimic->offset + end.offset};
    }
    disagree(robot_, "joint " + quote(joint.name) + " mimics itself");
  }

  void add_joint(const urdf::Joint& joint) {
    const Followed end = followed(joint);
    const std::string& master = end.name;
    const auto known = std::find_if(robot_.joints.begin(), robot_.joints.end(),
                                    [&](const Joint& other) { return other.name == master; });
    const auto held = std::find_if(robot_.held.begin(), robot_.held.end(),
                                   [&](const HeldJoint& other) { return other.name == master; });
    const bool is_held = known == robot_.joints.end() && held != robot_.held.end();
    if ((known == robot_.joints.end() && !is_held) || !model_->getJoint(master))
      disagree(robot_, "joint " + quote(master) + " is none of the robot's");
    if (joint.mimic) {
      kdl_.links.back().multiplier = end.multiplier;
      kdl_.links.back().offset = end.offset;
    }
    if (is_held) return hold(joint, *held, *model_->getJoint(master));
    kdl_.links.back().joint = static_cast<int>(known - robot_.joints.begin());
    require_limits(joint, known->lower);
    require_limits(joint, known->upper);
  }

  /// Prismatic values of held joints are of the full-size robot.
  void hold(const urdf::Joint& joint, const HeldJoint& held, const urdf::Joint& master) {
    const double value = held.value * (master.type == urdf::Joint::PRISMATIC ? robot_.scale : 1.0);
    require_limits(joint, value);
    kdl_.links.back().offset += kdl_.links.back().multiplier * value;
    kdl_.links.back().is_held = true;
  }

  /// Of a robot that plans for a group: its joints that move are the group's as the SRDF says, less those
  /// that are fixed by a flag or the settings.
  void require_group() const {
    if (robot_.group.empty()) return;
    const std::set<std::string> group = group_of_file(robot_, *model_);
    for (const Joint& joint : robot_.joints)
      if (!group.contains(joint.name))
        disagree(robot_, "joint " + quote(joint.name) + " is none of group " + quote(robot_.group));
    for (const HeldJoint& held : robot_.held)
      if (group.contains(held.name) && held.source != HoldSource::asked &&
          held.source != HoldSource::settings)
        disagree(robot_, "joint " + quote(held.name) + " of group " + quote(robot_.group) + " is held");
  }

  /// A limit of the robot's joint keeps what the file allows, of a mimic joint what its master makes of it.
  void require_limits(const urdf::Joint& joint, double end) const {
    if (joint.type == urdf::Joint::CONTINUOUS) return;
    if (!joint.limits) disagree(robot_, "joint " + quote(joint.name) + " has no limits");
    const bool endless = joint.type == urdf::Joint::REVOLUTE && joint.limits->lower < -endless_turn &&
                         joint.limits->upper > endless_turn;
    if (endless) return;
    const double factor = kdl_.links.back().multiplier;
    const double value = (factor == 0.0 ? 0.0 : factor * end) + kdl_.links.back().offset;
    if (value >= joint.limits->lower - limit_tolerance && value <= joint.limits->upper + limit_tolerance)
      return;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "joint " << quote(joint.name) << " may move to " << value << ", its limits there are "
         << joint.limits->lower << " to " << joint.limits->upper;
    disagree(robot_, text.str());
  }

  /// As bare_text has it.
  static bool is_mesh(const urdf::Collision& collision) {
    return collision.geometry && collision.geometry->type == urdf::Geometry::BOX;
  }

  /// Behind the bodies of all elements come the further convex pieces of meshes, each where its mesh is;
  /// null: none is there.
  static urdf::CollisionSharedPtr mesh_of_piece(const Body& body,
                                                const std::vector<urdf::CollisionSharedPtr>& collisions) {
    const auto found =
        std::find_if(collisions.begin(), collisions.end(), [&](const urdf::CollisionSharedPtr& collision) {
          return is_mesh(*collision) && isometry(collision->origin).isApprox(body.link_from_shape, 1e-9);
        });
    return found != collisions.end() ? *found : nullptr;
  }

  void add_bodies() {
    std::map<int, std::size_t> seen, all;
    for (std::size_t own = 0; own < own_bodies(robot_); ++own) ++all[robot_.bodies[own].link];
    for (std::size_t own = 0; own < own_bodies(robot_); ++own) {
      const Body& body = robot_.bodies[own];
      const std::string& link = robot_.links[static_cast<std::size_t>(body.link)].name;
      const auto& collisions = model_->links_.at(link)->collision_array;
      const std::size_t number = seen[body.link]++;
      const urdf::CollisionSharedPtr source =
          number < collisions.size() ? collisions[number] : mesh_of_piece(body, collisions);
      const bool is_hull = body.shape.name() == "convex";
      if (!source || (number >= collisions.size() && !is_hull))
        disagree(robot_, "link " + quote(link) + " has only " + counted(collisions.size(), "body", "bodies"));
      const bool has_pieces = all[body.link] > collisions.size();  // and none in the place of another body
      if (has_pieces ? is_hull != is_mesh(*source) : is_mesh(*source) && !is_hull)
        disagree(robot_, "a body of link " + quote(link) + (is_hull ? " is no mesh" : " is a mesh"));
      kdl_.link_from_body.push_back(isometry(source->origin));
    }
    for (std::size_t i = 0; i < own_links(robot_); ++i) {
      const auto& collisions = model_->links_.at(robot_.links[i].name)->collision_array;
      if (seen[static_cast<int>(i)] < collisions.size())
        disagree(robot_, "link " + quote(robot_.links[i].name) + " has " +
                             counted(collisions.size(), "body", "bodies") + ", not " +
                             std::to_string(seen[static_cast<int>(i)]));
    }
  }

  const Robot& robot_;
  urdf::ModelInterfaceSharedPtr model_;
  KDL::Tree tree_;
  KdlModel kdl_;
};

}  // namespace

void disagree(const Robot& robot, const std::string& what) {
  const std::string stated = robot.source.empty()
                                 ? "it is stated to be"
                                 : "its file " + urdf_of_robot(robot).string() + " says, read again";
  throw FileDisagrees("robot " + quote(robot.name) + " is not what " + stated + ": " + what);
}

KdlModel model_of_file(const Robot& robot) { return FileReader(robot).model(); }

}  // namespace clearway::check
