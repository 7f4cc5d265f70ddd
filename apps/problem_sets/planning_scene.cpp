#include "apps/problem_sets/planning_scene.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "datasets/descriptions/yaml_fields.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr Bounds sizes{tiny, 1e3};
constexpr std::size_t most_objects = 100'000;

std::string called(const std::filesystem::path& file) { return quote_path(file.string()); }

/// [x, y, z] or {x: …, y: …, z: …}; a coordinate that is left out is 0.
Eigen::VectorXd coordinates(const YamlFields& fields, const std::string& key, const std::string& names) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names.size()));
  if (!fields.has(key)) return values;
  if (fields.is_list(key)) {
    const std::vector<double> list = fields.numbers(key, within_reach, names.size());
    return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
  }
  const YamlFields map = fields.map(key);
  for (std::size_t i = 0; i < names.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = map.number(std::string(1, names[i]), within_reach, 0.0);
  return values;
}

/// A pose of a position and an orientation; transforms call them translation and rotation.
Eigen::Isometry3d pose_of(const YamlFields& fields, const std::string& position = "position",
                          const std::string& orientation = "orientation") {
  const Eigen::Vector3d at = coordinates(fields, position, "xyz");
  const Eigen::Vector4d turn = coordinates(fields, orientation, "xyzw");
  try {
    return pose_of_quaternion(at, turn);
  } catch (const std::invalid_argument& error) {
    fields.fail(orientation, error.what());
  }
}

std::string frame_of(const YamlFields& fields) {
  if (!fields.has("header")) return "";
  const YamlFields header = fields.map("header");
  std::string frame = header.has("frame_id") ? header.text("frame_id", "") : "";
  if (frame.starts_with('/')) frame.erase(0, 1);
  return frame;
}

/// @param state of a robot, as MoveIt has it.
void require_base_at_origin(const YamlFields& state) {
  if (!state.has("multi_dof_joint_state")) return;
  for (const YamlFields& pose : state.map("multi_dof_joint_state").list_of_maps("transforms"))
    if (!pose_of(pose, "translation", "rotation").isApprox(Eigen::Isometry3d::Identity(), 1e-9))
      pose.fail("translation", "expected the robot's base at the map's origin, as the robot stands there");
}

/// Joint values of a state of a robot, as MoveIt has it.
std::map<std::string, double> joints_of(const YamlFields& state) {
  std::map<std::string, double> values;
  if (!state.has("joint_state")) return values;
  const YamlFields joints = state.map("joint_state");
  const auto names = joints.texts("name");
  const auto positions = joints.numbers("position", within_reach);
  if (names.size() != positions.size())
    joints.fail("position", "expected " + std::to_string(names.size()) + " numbers, one for each name, got " +
                                std::to_string(positions.size()));
  for (std::size_t i = 0; i < names.size(); ++i) values[names[i]] = positions[i];
  return values;
}

bool is_true(const std::string& word) { return word == "true" || word == "True" || word == "1"; }

/// What moveit_msgs/AllowedCollisionMatrix allows to collide of scene objects and what is none.
struct AllowedPairs {
  AllowedPairs(const YamlFields& matrix, const std::set<std::string>& objects) {
    const auto names = matrix.texts("entry_names");
    const auto rows = matrix.lists_of_texts("entry_values", "enabled");
    const auto allows = [&](std::size_t i, std::size_t k) {
      return i < rows.size() && k < rows[i].size() && is_true(rows[i][k]);
    };
    std::vector<bool> is_object;
    for (const std::string& name : names) is_object.push_back(objects.contains(name));
    for (std::size_t i = 0; i < names.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) {
        if (is_object[i] == is_object[k] || !(allows(i, k) || allows(k, i))) continue;
        if (count++ == 0) first = quote(names[k]) + " with " + quote(names[i]);
      }
    const auto defaults = matrix.texts("default_entry_names"), values = matrix.texts("default_entry_values");
    for (std::size_t i = 0; i < std::min(defaults.size(), values.size()); ++i)
      if (objects.contains(defaults[i]) && is_true(values[i])) by_default.push_back(defaults[i]);
  }

  std::size_t count = 0;
  std::string first;
  std::vector<std::string> by_default;  ///< objects that may collide with whatever no pair names
};

class SceneReader {
 public:
  SceneReader(const std::string& text, const std::filesystem::path& file, const SceneContext& context,
              std::vector<std::string>& left_out)
      : scene_(text, "scene " + called(file)), file_(file), context_(context), left_out_(left_out) {}

  ForeignWorld read() {
    world_.name = file_.stem().string();
    read_frames();
    const YamlFields world = scene_.map("world");
    if (world.has("octomap")) leave_octomap(world.map("octomap"));
    const auto objects = world.list_of_maps("collision_objects");
    if (objects.size() > most_objects) world.fail("collision_objects", "expected at most 100000 of them");
    for (const YamlFields& object : objects) add_object(object);
    if (scene_.has("robot_state")) {
      leave_attached(scene_.map("robot_state"));
      world_.joints = joints_of(scene_.map("robot_state"));
    }
    leave_robot_name();
    leave_allowed_pairs();
    leave_link_sizes("link_padding", "padding", 0.0);
    leave_link_sizes("link_scale", "scale", 1.0);
    return std::move(world_);
  }

 private:
  void leave(const std::string& what) { left_out_.push_back(file_.filename().string() + ": " + what); }

  void read_frames() {
    frames_[""] = frames_["world"] = Eigen::Isometry3d::Identity();
    for (const auto& [frame, pose] : context_.frames) frames_[frame] = pose;
    for (const YamlFields& entry : scene_.list_of_maps("fixed_frame_transforms"))
      if (entry.has("transform")) read_frame(entry);
  }

  /// MoveIt calls the frame that it places `header`, and the known one that it is placed in `child`; where
  /// only the other one is known, the names mean what tf means by them.
  void read_frame(const YamlFields& entry) {
    std::string placed = frame_of(entry), in = entry.text("child_frame_id", "");
    if (in.starts_with('/')) in.erase(0, 1);
    if (!frames_.contains(in)) std::swap(placed, in);
    const auto known = frames_.find(in);
    if (known == frames_.end()) return;
    const Eigen::Isometry3d pose = known->second * pose_of(entry.map("transform"), "translation", "rotation");
    const auto [frame, is_new] = frames_.emplace(placed, pose);
    if (!is_new && !frame->second.isApprox(pose, 1e-9))
      entry.fail("transform", "expected none for frame " + quote(placed) + ", which is the map's own");
  }

  void leave_octomap(const YamlFields& octomap) {
    if (!octomap.has("octomap")) return;
    const YamlFields inner = octomap.map("octomap");
    if (inner.is_list("data") ? !inner.numbers("data", within_reach).empty() : inner.has("data"))
      leave("its octomap");
  }

  void leave_attached(const YamlFields& state) {
    require_base_at_origin(state);
    for (const YamlFields& attached : state.list_of_maps("attached_collision_objects")) {
      const std::string name = attached.has("object") ? attached.map("object").text("id", "") : std::string();
      leave("attached body " + quote(name));
    }
  }

  void leave_robot_name() {
    const std::string name = scene_.text("robot_model_name", "");
    if (name.empty() || context_.robot_names.empty() || context_.robot_names.contains(name)) return;
    leave("its robot_model_name, " + quote(name) + ", which is not the robot's name");
  }

  /// Links may touch the objects with which these pairs name them; pairs of links are the SRDF's, and those
  /// of objects say nothing of the robot.
  void leave_allowed_pairs() {
    if (!scene_.has("allowed_collision_matrix")) return;
    const AllowedPairs pairs(scene_.map("allowed_collision_matrix"), objects_);
    if (pairs.count > 0)
      leave("its allowed_collision_matrix: " + std::to_string(pairs.count) +
            " pairs with an object that may collide, the first " + pairs.first);
    if (!pairs.by_default.empty())
      leave("its allowed_collision_matrix: objects that may collide with everything: " +
            listed(pairs.by_default));
  }

  void leave_link_sizes(const std::string& key, const std::string& field, double usual) {
    std::vector<std::string> links;
    for (const YamlFields& entry : scene_.list_of_maps(key))
      if (entry.number(field, within_reach, usual) != usual) links.push_back(entry.text("link_name", ""));
    if (!links.empty()) leave("its " + key + " of " + listed(links));
  }

  void add_object(const YamlFields& object) {
    const std::string name = object.text("id");
    objects_.insert(name);
    const std::string operation = object.has("operation") ? object.text("operation") : "0";
    if (operation != "0" && operation != "add" && operation != "append" && operation != "2")
      return leave("object " + quote(name) + ", which is not added (operation " + quote(operation) + ")");
    const std::string frame = frame_of(object);
    const auto known = frames_.find(frame);
    if (known == frames_.end())
      return leave("object " + quote(name) + " in frame " + quote(frame) + ", which is not the map's");
    const Eigen::Isometry3d map_from_object =
        known->second * (object.has("pose") ? pose_of(object.map("pose")) : Eigen::Isometry3d::Identity());
    add_primitives(object, name, map_from_object);
    add_meshes(object, name, map_from_object);
    if (!object.has("primitives") && !object.has("meshes") && !object.has("planes"))
      leave("object " + quote(name) + ", which has neither primitives nor meshes");
    const auto planes = object.list_of_maps("planes");
    if (!planes.empty()) leave("planes of object " + quote(name));
  }

  /// Poses of the pieces of an object, one for each.
  static std::vector<Eigen::Isometry3d> poses(const YamlFields& object, const std::string& key,
                                              std::size_t count) {
    std::vector<Eigen::Isometry3d> result;
    for (const YamlFields& pose : object.list_of_maps(key)) result.push_back(pose_of(pose));
    if (result.empty() && count == 1) result.push_back(Eigen::Isometry3d::Identity());
    if (result.size() != count)
      object.fail(key, "expected " + std::to_string(count) + " poses, one for each piece, got " +
                           std::to_string(result.size()));
    return result;
  }

  void add_primitives(const YamlFields& object, const std::string& name,
                      const Eigen::Isometry3d& map_from_object) {
    const auto primitives = object.list_of_maps("primitives");
    const auto object_from = poses(object, "primitive_poses", primitives.size());
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      ForeignSolid solid;
      solid.object = name;
      solid.map_from_shape = map_from_object * object_from[i];
      read_primitive(primitives[i], solid);
      world_.solids.push_back(std::move(solid));
    }
  }

  /// shape_msgs/SolidPrimitive: box x, y, z; sphere radius; cylinder and cone height, radius.
  static void read_primitive(const YamlFields& primitive, ForeignSolid& solid) {
    const std::string type = primitive.text("type");
    const auto dimensions = [&](std::size_t count) { return primitive.numbers("dimensions", sizes, count); };
    if (type == "1" || type == "box") {
      const auto d = dimensions(3);
      solid.kind = "box";
      solid.shape = Shape::box({d[0], d[1], d[2]});
    } else if (type == "2" || type == "sphere") {
      solid.kind = "sphere";
      solid.shape = Shape::sphere(dimensions(1)[0]);
    } else if (type == "3" || type == "cylinder") {
      const auto d = dimensions(2);
      solid.kind = "cylinder";
      solid.shape = Shape::cylinder(d[1], d[0]);
    } else if (type == "4" || type == "cone") {
      const auto d = dimensions(2);
      solid.kind = "cone";
      solid.shape = cone_shape(d[1], d[0]);
    } else {
      primitive.fail("type", "expected box, sphere, cylinder or cone (1 to 4), got " + quote(type));
    }
  }

  void add_meshes(const YamlFields& object, const std::string& name,
                  const Eigen::Isometry3d& map_from_object) {
    const auto meshes = object.list_of_maps("meshes");
    const auto object_from = poses(object, "mesh_poses", meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      ForeignSolid solid;
      solid.object = name;
      solid.kind = "mesh";
      solid.map_from_shape = map_from_object * object_from[i];
      solid.triangles = meshes[i].has("resource") ? mesh_of_file(meshes[i]) : mesh_inside(meshes[i]);
      world_.solids.push_back(std::move(solid));
    }
  }

  std::vector<Eigen::Vector3d> mesh_of_file(const YamlFields& mesh) const {
    ScaledMesh named;
    if (mesh.has("dimensions")) {
      const auto scale = mesh.numbers("dimensions", sizes, 3);
      named.scale = {scale[0], scale[1], scale[2]};
    }
    try {
      named.file = find_mesh(mesh.file("resource"), file_.parent_path(), context_.packages);
    } catch (const std::invalid_argument& error) {
      mesh.fail("resource", error.what());
    }
    MeshTriangles triangles = read_mesh_triangles(named);
    if (!triangles.failure.empty()) mesh.fail("resource", triangles.failure);
    return std::move(triangles.corners);
  }

  /// ROS writes points as maps and triangles as maps of `vertex_indices`, Robowflex both as lists.
  static std::vector<Eigen::Vector3d> mesh_inside(const YamlFields& mesh) {
    std::vector<Eigen::Vector3d> vertices, corners;
    if (!mesh.is_list("vertices") || !mesh.is_list("triangles"))
      mesh.fail("vertices", "expected a mesh of 'resource', or of lists 'vertices' and 'triangles'");
    for (const auto& at : mesh.rows("vertices", {-1e3, 1e3}, 3, {"x", "y", "z"}))
      vertices.emplace_back(at[0], at[1], at[2]);
    if (vertices.empty()) mesh.fail("vertices", "expected at least one");
    const Bounds indices{0, static_cast<double>(vertices.size()) - 1};
    for (const auto& triangle : mesh.rows("triangles", indices, 3, {"vertex_indices"}))
      for (const double index : triangle) {
        if (index != std::floor(index)) mesh.fail("triangles", "expected whole numbers");
        corners.push_back(vertices[static_cast<std::size_t>(index)]);
      }
    if (corners.empty()) mesh.fail("triangles", "expected at least one");
    return corners;
  }

  YamlFields scene_;
  const std::filesystem::path& file_;
  const SceneContext& context_;
  std::vector<std::string>& left_out_;
  std::map<std::string, Eigen::Isometry3d> frames_;
  std::set<std::string> objects_;  ///< names
  ForeignWorld world_;
};

void read_start(const YamlFields& request, ForeignState& start, std::vector<std::string>& left) {
  if (!request.has("start_state")) return;
  const YamlFields state = request.map("start_state");
  for (const YamlFields& attached : state.list_of_maps("attached_collision_objects"))
    left.push_back("attached body " +
                   quote(attached.has("object") ? attached.map("object").text("id", "") : std::string()));
  require_base_at_origin(state);
  start.by_joint = joints_of(state);
}

}  // namespace

bool is_request_text(const std::string& text, const std::filesystem::path& file) {
  const YamlFields fields(text, "file " + called(file));
  if (fields.has("world")) return false;
  if (fields.has("goal_constraints") || fields.has("start_state")) return true;
  fields.fail("world", "expected a scene with 'world', or a request with 'goal_constraints'");
}

ForeignWorld read_planning_scene(const std::string& text, const std::filesystem::path& file,
                                 const SceneContext& context, std::vector<std::string>& left_out) {
  return SceneReader(text, file, context, left_out).read();
}

ForeignProblem read_motion_request(const std::string& text, const std::filesystem::path& file,
                                   std::vector<std::string>& left_out) {
  const YamlFields request(text, "request " + called(file));
  const auto leave = [&](const std::string& what) {
    left_out.push_back(file.filename().string() + ": " + what);
  };
  ForeignProblem problem;
  problem.name = file.stem().string();
  problem.group = request.has("group_name") ? request.text("group_name", "") : "";
  std::vector<std::string> left;
  read_start(request, problem.start, left);
  for (const std::string& what : left) leave(what);
  std::size_t goals = 0;
  for (const YamlFields& goal : request.list_of_maps("goal_constraints")) {
    const auto joints = goal.list_of_maps("joint_constraints");
    for (const char* other : {"position_constraints", "orientation_constraints", "visibility_constraints"})
      if (!goal.list_of_maps(other).empty()) leave(std::string(other) + " of a goal");
    if (joints.empty() || ++goals > 1) continue;
    for (const YamlFields& joint : joints)
      problem.goal.by_joint[joint.text("joint_name")] = joint.number("position", within_reach);
  }
  if (goals > 1)
    leave(std::to_string(goals - 1) + " of " + std::to_string(goals) + " goals: the first counts");
  if (request.has("path_constraints")) {
    const YamlFields path = request.map("path_constraints");
    for (const char* kind : {"joint_constraints", "position_constraints", "orientation_constraints"})
      if (!path.list_of_maps(kind).empty()) leave(std::string(kind) + " of the path");
  }
  return problem;
}

}  // namespace clearway
