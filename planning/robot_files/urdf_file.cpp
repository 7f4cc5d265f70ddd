#include "planning/robot_files/urdf_file.hpp"

#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mapping/files/map_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/mimic_joints.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/mesh_file.hpp"
#include "planning/robot_files/urdf_document.hpp"
#include "planning/robot_files/urdf_messages.hpp"
#include "planning/robot_files/xacro_file.hpp"

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
  Reader(const std::filesystem::path& file, const UrdfDocument& document, const urdf::ModelInterface& model,
         const PackageFolders& packages, const MeshPieces& pieces)
      : file_(file), document_(document), model_(model), packages_(packages), pieces_(pieces) {
    robot_.name = robot_.model = model.getName();
    robot_.source = file;
    robot_.only_seen = document.only_seen;
  }

  Robot robot() {
    add_link(*model_.getRoot(), -1);
    for (const auto& [link, pieces] : pieces_.of_link)
      if (std::none_of(meshes_.begin(), meshes_.end(), [&, &part = link](const NamedMesh& named) {
            return robot_.bodies[named.body].part == part;
          }))
        refuse("has no link " + quote(link) + " with a mesh, which mesh_pieces of its settings name");
    read_meshes();
    resolve_mimics(file_, mimics_, robot_);
    if (robot_.joints.empty()) refuse("no joint can move, expected at least one revolute or prismatic joint");
    if (std::none_of(robot_.bodies.begin(), robot_.bodies.end(),
                     [&](const Body& body) { return is_moved(robot_, body.link); })) {
      refuse(
          "no link that a joint moves has a <collision> body, expected at least one: nothing could be "
          "checked against a map");
    }
    return std::move(robot_);
  }

 private:
  /// A body whose shape is still to be read.
  struct NamedMesh {
    std::size_t body = 0;
    ScaledMesh mesh;
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
    link.joint_name = source.name;
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
    if (source.limits) joint.max_velocity = std::max(source.limits->velocity, 0.0);  // -1: none
    const UrdfDocument::Changes& changes = document_.changes.at(source.name);
    joint.max_acceleration = changes.acceleration;
    joint.max_jerk = changes.jerk;
    if (source.mimic) {
      mimics_.push_back({static_cast<int>(robot_.links.size()), joint, source.mimic->joint_name});
      link.multiplier = source.mimic->multiplier;
      link.offset = source.mimic->offset;
      return;
    }
    link.joint = static_cast<int>(robot_.joints.size());
    robot_.joints.push_back(joint);
  }

  void add_bodies(const urdf::Link& source, int link) {
    const std::vector<bool>& is_capsule = document_.is_capsule.at(source.name);
    if (source.collision_array.size() != is_capsule.size()) {
      refuse("link " + quote(source.name) + ": " + std::to_string(is_capsule.size()) +
             " <collision> elements, but only " + std::to_string(source.collision_array.size()) +
             " could be read");
    }
    for (std::size_t i = 0; i < is_capsule.size(); ++i) {
      const urdf::Collision& collision = *source.collision_array[i];
      if (!collision.geometry) refuse("link " + quote(source.name) + ": a <collision> could not be read");
      Body body;
      body.part = source.name;
      body.link = link;
      body.link_from_shape = isometry(collision.origin);
      if (collision.geometry->type == urdf::Geometry::MESH) {
        meshes_.push_back({robot_.bodies.size(), mesh(source.name, *collision.geometry)});
      } else {
        body.shape = shape(source.name, *collision.geometry, is_capsule[i]);
      }
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
        case urdf::Geometry::MESH:
          break;
      }
    } catch (const std::invalid_argument& error) {
      refuse("link " + quote(link) + ": " + error.what());
    }
    refuse("link " + quote(link) + ": unknown collision shape");
  }

  ScaledMesh mesh(const std::string& link, const urdf::Geometry& geometry) const {
    const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
    try {
      return {find_mesh(mesh.filename, file_.parent_path(), packages_),
              {mesh.scale.x, mesh.scale.y, mesh.scale.z},
              pieces_.of_link.contains(link) ? pieces_.of_link.at(link) : pieces_.of_all};
    } catch (const std::invalid_argument& error) {
      refuse("link " + quote(link) + ": " + error.what());
    }
  }

  /// All at once, each once: they are read in a process of their own, which takes time to start.
  void read_meshes() {
    std::vector<ScaledMesh> distinct;
    for (const NamedMesh& named : meshes_) {
      if (std::find(distinct.begin(), distinct.end(), named.mesh) == distinct.end())
        distinct.push_back(named.mesh);
    }
    const std::vector<MeshHull> hulls = read_mesh_hulls(distinct);
    std::vector<std::pair<Body, std::vector<Eigen::Vector3d>>> further;  // behind all others
    for (const NamedMesh& named : meshes_) {
      const auto found = std::find(distinct.begin(), distinct.end(), named.mesh);
      const MeshHull& hull = hulls[static_cast<std::size_t>(found - distinct.begin())];
      Body& body = robot_.bodies[named.body];
      const std::string sentence = file_.string() + ": link " + quote(body.part) + ": " + hull.failure;
      if (hull.is_damaged) throw DamagedFile(sentence);
      if (!hull.failure.empty()) throw std::invalid_argument(sentence);
      body.shape = Shape::convex(hull.corners);
      for (const std::vector<Eigen::Vector3d>& corners : hull.further) further.push_back({body, corners});
    }
    for (auto& [body, corners] : further) {
      body.shape = Shape::convex(corners);
      robot_.bodies.push_back(body);
    }
  }

  const std::filesystem::path& file_;
  const UrdfDocument& document_;
  const urdf::ModelInterface& model_;
  const PackageFolders& packages_;
  const MeshPieces& pieces_;
  Robot robot_;
  std::vector<MimicJoint> mimics_;
  std::vector<NamedMesh> meshes_;
};

}  // namespace

Robot read_urdf(const std::filesystem::path& file, const PackageFolders& packages,
                const XacroArguments& arguments, const MeshPieces& pieces) {
  const UrdfDocument document = read_urdf_document(file, arguments);
  if (document.joint_order.empty()) throw std::invalid_argument(file.string() + ": has no joints");
  const KeptMessages messages;  // dropped: they name urdfdom's functions
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(document.text);
  } catch (const std::exception&) {  // no model is sentence enough
  }
  if (!model || !model->getRoot())
    throw std::invalid_argument(file.string() + ": is not a URDF of links, joints and shapes");
  Robot robot = Reader(file, document, *model, packages, pieces).robot();
  robot.xacro = arguments;
  return robot;
}

}  // namespace clearway
