#include "planning/urdf_file.hpp"

#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "planning/mesh_file.hpp"
#include "planning/reach.hpp"
#include "planning/urdf_document.hpp"
#include "planning/urdf_messages.hpp"

namespace clearway {
namespace {

Eigen::Isometry3d isometry(const urdf::Pose& pose) {
  Eigen::Quaterniond rotation;
  pose.rotation.getQuaternion(rotation.x(), rotation.y(), rotation.z(), rotation.w());
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = rotation.normalized().toRotationMatrix();
  result.translation() << pose.position.x, pose.position.y, pose.position.z;
  return result;
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, const UrdfDocument& document, const urdf::ModelInterface& model)
      : file_(file), document_(document), model_(model) {
    robot_.name = model.getName();
    robot_.source = file;
  }

  Robot robot() {
    add_link(*model_.getRoot(), -1);
    resolve_mimics();
    if (robot_.joints.empty()) refuse("no joint can move, expected at least one revolute or prismatic joint");
    if (std::none_of(robot_.bodies.begin(), robot_.bodies.end(),
                     [&](const Body& body) { return is_moved(robot_, body.link); })) {
      refuse(
          "no link that a joint moves has a <collision> body, expected at least one: nothing could be "
          "checked against a map");
    }
    robot_.tip_link = deepest_link();
    return std::move(robot_);
  }

 private:
  struct Mimic {
    int link = 0;
    Joint joint;
    std::string master;
  };

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::invalid_argument(file_.string() + ": " + what);
  }

  void add_link(const urdf::Link& source, int parent) {
    Link link;
    link.name = source.name;
    link.parent = parent;
    if (source.parent_joint) add_joint(*source.parent_joint, link);
    if (source.inertial) {
      link.mass = source.inertial->mass;
      link.center_of_mass = isometry(source.inertial->origin).translation();
      if (!std::isfinite(link.mass) || link.mass < 0.0 || !link.center_of_mass.allFinite()) {
        refuse("link '" + link.name + "': the mass must be finite and not below 0");
      }
    }
    const int index = static_cast<int>(robot_.links.size());
    robot_.links.push_back(link);
    add_bodies(source, index);
    for (const std::string& name : document_.joint_order) {
      const urdf::JointConstSharedPtr joint = model_.getJoint(name);
      if (joint && joint->parent_link_name == source.name)
        add_link(*model_.getLink(joint->child_link_name), index);
    }
  }

  void add_joint(const urdf::Joint& source, Link& link) {
    link.parent_from_link = isometry(source.parent_to_joint_origin_transform);
    if (source.type == urdf::Joint::FIXED) return;
    Joint joint;
    joint.name = source.name;
    joint.kind = source.type == urdf::Joint::PRISMATIC ? JointKind::prismatic : JointKind::revolute;
    joint.axis = Eigen::Vector3d(source.axis.x, source.axis.y, source.axis.z).normalized();
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
    if (source.type != urdf::Joint::CONTINUOUS) {
      joint.lower = source.limits->lower;
      joint.upper = source.limits->upper;
    }
    if (source.limits) joint.max_velocity = source.limits->velocity;
    if (!std::isfinite(joint.max_velocity) || joint.max_velocity < 0.0) {
      refuse("joint '" + joint.name + "': the velocity limit must be finite and not below 0");
    }
    if (source.mimic) {
      mimics_.push_back({static_cast<int>(robot_.links.size()), joint, source.mimic->joint_name});
      link.multiplier = source.mimic->multiplier;
      link.offset = source.mimic->offset;
      if (!std::isfinite(link.multiplier) || !std::isfinite(link.offset)) {
        refuse("joint '" + joint.name + "': mimic multiplier and offset must be finite");
      }
      return;
    }
    link.joint = static_cast<int>(robot_.joints.size());
    robot_.joints.push_back(joint);
  }

  void add_bodies(const urdf::Link& source, int link) {
    const std::vector<bool>& is_capsule = document_.is_capsule.at(source.name);
    if (source.collision_array.size() != is_capsule.size()) {
      refuse("link '" + source.name + "': " + std::to_string(is_capsule.size()) +
             " <collision> elements, but only " + std::to_string(source.collision_array.size()) +
             " could be read");
    }
    for (std::size_t i = 0; i < is_capsule.size(); ++i) {
      const urdf::Collision& collision = *source.collision_array[i];
      if (!collision.geometry) refuse("link '" + source.name + "': a <collision> could not be read");
      Body body;
      body.part = source.name;
      body.link = link;
      body.link_from_shape = isometry(collision.origin);
      body.shape = shape(source.name, *collision.geometry, is_capsule[i]);
      robot_.bodies.push_back(std::move(body));
    }
  }

  Shape shape(const std::string& link, const urdf::Geometry& geometry, bool capsule) const {
    try {
      switch (geometry.type) {
        case urdf::Geometry::SPHERE:
          return Shape::sphere(static_cast<const urdf::Sphere&>(geometry).radius);
        case urdf::Geometry::BOX: {
          const urdf::Vector3& edges = static_cast<const urdf::Box&>(geometry).dim;
          return Shape::box({edges.x, edges.y, edges.z});
        }
        case urdf::Geometry::CYLINDER: {
          const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
          return capsule ? Shape::capsule(cylinder.radius, cylinder.length)
                         : Shape::cylinder(cylinder.radius, cylinder.length);
        }
        case urdf::Geometry::MESH: {
          const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
          return Shape::convex(read_mesh_vertices(find_mesh(mesh.filename, file_.parent_path()),
                                                  {mesh.scale.x, mesh.scale.y, mesh.scale.z}));
        }
      }
    } catch (const std::invalid_argument& error) {
      refuse("link '" + link + "': " + error.what());
    }
    refuse("link '" + link + "': unknown collision shape");
  }

  void resolve_mimics() {
    for (const Mimic& mimic : mimics_) {
      const auto master = std::find_if(robot_.joints.begin(), robot_.joints.end(),
                                       [&](const Joint& joint) { return joint.name == mimic.master; });
      if (master == robot_.joints.end() || master->kind != mimic.joint.kind) {
        refuse("joint '" + mimic.joint.name + "' mimics '" + mimic.master +
               "', expected an existing joint of the same kind that mimics none itself");
      }
      robot_.links[static_cast<std::size_t>(mimic.link)].joint =
          static_cast<int>(master - robot_.joints.begin());
      keep_mimic_limits(mimic, *master);
      turn_link_frame(mimic.link, master->axis, mimic.joint.axis);
    }
  }

  /// Narrows the master's limits so that multiplier * q + offset keeps the mimic joint's own.
  void keep_mimic_limits(const Mimic& mimic, Joint& master) const {
    const Link& link = robot_.links[static_cast<std::size_t>(mimic.link)];
    double lower = mimic.joint.lower - link.offset, upper = mimic.joint.upper - link.offset;
    bool possible = lower <= 0.0 && upper >= 0.0;
    if (link.multiplier != 0.0) {
      lower /= link.multiplier;
      upper /= link.multiplier;
      if (link.multiplier < 0.0) std::swap(lower, upper);
      master.lower = std::max(master.lower, lower);
      master.upper = std::min(master.upper, upper);
      possible = master.lower <= master.upper;
    }
    if (!possible) {
      refuse("joint '" + mimic.joint.name + "' mimics '" + mimic.master +
             "' and is never within its own limits");
    }
  }

  /// Makes the master's axis, read in the frame of the link, mean the link's own axis.
  void turn_link_frame(int index, const Eigen::Vector3d& master_axis, const Eigen::Vector3d& own_axis) {
    Link& link = robot_.links[static_cast<std::size_t>(index)];
    if (master_axis.isApprox(own_axis, 1e-12)) return;
    if (master_axis.isApprox(-own_axis, 1e-12)) {
      link.multiplier = -link.multiplier;
      link.offset = -link.offset;
      return;
    }
    const Eigen::Isometry3d old_from_new(Eigen::Quaterniond::FromTwoVectors(master_axis, own_axis));
    const Eigen::Isometry3d new_from_old = old_from_new.inverse();
    link.parent_from_link = link.parent_from_link * old_from_new;
    link.center_of_mass = new_from_old * link.center_of_mass;
    for (Link& child : robot_.links) {
      if (child.parent == index) child.parent_from_link = new_from_old * child.parent_from_link;
    }
    for (Body& body : robot_.bodies) {
      if (body.link == index) body.link_from_shape = new_from_old * body.link_from_shape;
    }
  }

  int deepest_link() const {
    std::vector<int> depth(robot_.links.size(), 0);
    int best = 0;
    for (std::size_t i = 1; i < robot_.links.size(); ++i) {
      depth[i] = depth[static_cast<std::size_t>(robot_.links[i].parent)] + 1;
      if (depth[i] > depth[static_cast<std::size_t>(best)]) best = static_cast<int>(i);
    }
    return best;
  }

  const std::filesystem::path& file_;
  const UrdfDocument& document_;
  const urdf::ModelInterface& model_;
  Robot robot_;
  std::vector<Mimic> mimics_;
};

}  // namespace

Robot read_urdf(const std::filesystem::path& file) {
  const UrdfDocument document = read_urdf_document(file);
  if (document.joint_order.empty()) throw std::invalid_argument(file.string() + ": has no joints");
  KeptMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(document.text);
  } catch (const std::exception& error) {
    messages.first = error.what();
  }
  if (!model || !model->getRoot()) {
    throw std::invalid_argument(file.string() + ": is not a valid URDF: " + messages.first);
  }
  return Reader(file, document, *model).robot();
}

}  // namespace clearway
