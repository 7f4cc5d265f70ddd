#include "apps/problem_sets/scene_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "datasets/yaml/message_keys.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr Bounds sizes{tiny, 1e3};

}  // namespace

std::vector<Eigen::Vector3d> mesh_of_file(const YamlFields& mesh, const std::string& key,
                                          const Eigen::Vector3d& scale, const PackageFolders& packages,
                                          const std::filesystem::path& folder) {
  ScaledMesh named;
  named.scale = scale;
  try {
    named.file = find_mesh(mesh.file(key), folder, packages);
  } catch (const std::invalid_argument& error) {
    mesh.fail(key, error.what());
  }
  MeshTriangles triangles = read_mesh_triangles(named);
  if (!triangles.failure.empty()) mesh.fail(key, triangles.failure);
  return std::move(triangles.corners);
}

std::vector<Eigen::Vector3d> mesh_of_lists(const YamlFields& mesh, const std::string& vertex_key,
                                           const std::string& triangle_key) {
  std::vector<Eigen::Vector3d> vertices, corners;
  for (const auto& at : mesh.rows(vertex_key, {-1e3, 1e3}, 3, {"x", "y", "z"}))
    vertices.emplace_back(at[0], at[1], at[2]);
  if (vertices.empty()) mesh.fail(vertex_key, "expected at least one");
  const Bounds indices{0, static_cast<double>(vertices.size()) - 1};
  for (const auto& triangle : mesh.rows(triangle_key, indices, 3, {"vertex_indices"}))
    for (const double index : triangle) {
      if (index != std::floor(index)) mesh.fail(triangle_key, "expected whole numbers");
      corners.push_back(vertices[static_cast<std::size_t>(index)]);
    }
  if (corners.empty()) mesh.fail(triangle_key, "expected at least one");
  return corners;
}

namespace {

std::vector<Eigen::Vector3d> mesh_of_resource(const YamlFields& mesh, const PackageFolders& packages,
                                              const std::filesystem::path& folder) {
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  if (mesh.has("dimensions")) {
    const auto given = mesh.numbers("dimensions", sizes, 3);
    scale = {given[0], given[1], given[2]};
  }
  return mesh_of_file(mesh, "resource", scale, packages, folder);
}

/// ROS writes points as maps and triangles as maps of `vertex_indices`, Robowflex both as lists.
std::vector<Eigen::Vector3d> mesh_inside(const YamlFields& mesh) {
  if (!mesh.is_list("vertices") || !mesh.is_list("triangles"))
    mesh.fail("vertices", "expected a mesh of 'resource', or of lists 'vertices' and 'triangles'");
  return mesh_of_lists(mesh, "vertices", "triangles");
}

}  // namespace

namespace {

/// "x, y, z"
std::string spaced(const std::string& names) {
  std::string text;
  for (const char name : names) text += (text.empty() ? "" : ", ") + std::string(1, name);
  return text;
}

}  // namespace

Eigen::VectorXd ros_coordinates(const YamlFields& fields, const std::string& key, const std::string& names) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names.size()));
  if (!fields.has(key)) return values;
  if (fields.is_list(key)) {
    const std::vector<double> list = fields.numbers(key, within_reach, names.size());
    return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
  }
  const YamlFields map = fields.map(key);
  for (const std::string& name : map.keys())
    if (name.size() != 1 || names.find(name) == std::string::npos)
      map.fail(name, "expected no such key, as what it says would be lost; known are " + spaced(names));
  for (std::size_t i = 0; i < names.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = map.number(std::string(1, names[i]), within_reach, 0.0);
  return values;
}

Eigen::Matrix3d ros_turn(const YamlFields& fields, const std::string& key) {
  const Eigen::Vector4d turn = ros_coordinates(fields, key, "xyzw");
  try {
    return pose_of_quaternion(Eigen::Vector3d::Zero(), turn).linear();
  } catch (const std::invalid_argument& error) {
    fields.fail(key, error.what());
  }
}

namespace {

Eigen::Isometry3d pose_of_parts(const YamlFields& fields, const std::string& place, const std::string& turn) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = ros_coordinates(fields, place, "xyz");
  pose.linear() = ros_turn(fields, turn);
  return pose;
}

}  // namespace

Eigen::Isometry3d ros_pose(const YamlFields& pose) {
  require_no_lost_keys(pose, RosMessage::pose);
  return pose_of_parts(pose, "position", "orientation");
}

Eigen::Isometry3d ros_transform(const YamlFields& transform) {
  require_no_lost_keys(transform, RosMessage::transform);
  return pose_of_parts(transform, "translation", "rotation");
}

std::string ros_word(const YamlFields& fields, const std::string& key) {
  return fields.prose(key, "").empty() ? "" : fields.text(key);
}

bool ros_truth(const std::string& word) { return word == "true" || word == "True" || word == "1"; }

std::string ros_operation(const YamlFields& object) {
  static const std::array<std::string, 4> known{"add", "remove", "append", "move"};
  std::string word;
  if (const auto number = object.control_character("operation"))
    word = std::to_string(*number);
  else
    word = ros_word(object, "operation");
  for (char& c : word)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (word.empty()) return known[0];
  if (word.size() == 1 && word[0] >= '0' && word[0] <= '3')
    return known[static_cast<std::size_t>(word[0] - '0')];
  if (std::find(known.begin(), known.end(), word) == known.end())
    object.fail("operation", "expected ADD (0), REMOVE (1), APPEND (2) or MOVE (3), got " + quote(word));
  return word;
}

std::string ros_frame(const YamlFields& fields) {
  if (!fields.has("header")) return "";
  const YamlFields header = fields.map("header");
  require_no_lost_keys(header, RosMessage::header);
  std::string frame = ros_word(header, "frame_id");
  if (frame.starts_with('/')) frame.erase(0, 1);
  return frame;
}

namespace {

bool is_same_place(const Eigen::Isometry3d& one, const Eigen::Isometry3d& other) {
  return one.isApprox(other, 1e-9);
}

}  // namespace

std::optional<RosBase> ros_base(const YamlFields& state) {
  require_no_lost_keys(state, RosMessage::robot_state);
  if (!state.has("multi_dof_joint_state")) return std::nullopt;
  const YamlFields joints = state.map("multi_dof_joint_state");
  require_no_lost_keys(joints, RosMessage::multi_dof_joint_state);
  const std::vector<YamlFields> transforms = joints.list_of_maps("transforms");
  if (transforms.empty()) return std::nullopt;
  RosBase base{ros_frame(joints), Eigen::Isometry3d::Identity()};
  for (const YamlFields& transform : transforms)
    if (const Eigen::Isometry3d pose = ros_transform(transform); !is_same_place(pose, base.pose)) {
      if (transforms.size() > 1)
        joints.fail("transforms", "expected one, of the robot's base, or none that moves a joint, got " +
                                      std::to_string(transforms.size()));
      base.pose = pose;
    }
  return base;
}

void require_base_of(const SceneFrames& frames, const YamlFields& state) {
  const std::optional<RosBase> base = ros_base(state);
  if (!base) return;
  const bool is_at_root = is_same_place(base->pose, Eigen::Isometry3d::Identity());
  if (!is_at_root && !frames.is_planning_frame(base->frame))
    state.fail("multi_dof_joint_state", "expected the robot's base in the planning frame, got frame " +
                                            quote(base->frame) + ", in which the scene does not stand");
  if (!is_same_place(base->pose * frames.map_from_planning(), Eigen::Isometry3d::Identity()))
    state.fail("multi_dof_joint_state",
               "expected the robot's base where the scene has it, as a map is the scene about that base");
}

std::map<std::string, double> ros_joints(const YamlFields& state) {
  std::map<std::string, double> values;
  if (!state.has("joint_state")) return values;
  const YamlFields joints = state.map("joint_state");
  const auto names = joints.texts("name");
  const auto positions = joints.numbers("position", within_reach);
  if (names.size() != positions.size())
    joints.fail("position", "expected " + counted(names.size(), "number") + ", one for each name, got " +
                                std::to_string(positions.size()));
  for (std::size_t i = 0; i < names.size(); ++i) values[names[i]] = positions[i];
  return values;
}

void read_primitive(const YamlFields& primitive, ForeignSolid& solid) {
  require_no_lost_keys(primitive, RosMessage::primitive);
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

std::vector<Eigen::Isometry3d> ros_poses(const YamlFields& fields, const std::string& key,
                                         std::size_t count) {
  std::vector<Eigen::Isometry3d> result;
  for (const YamlFields& pose : fields.list_of_maps(key)) result.push_back(ros_pose(pose));
  if (result.empty() && count == 1) result.push_back(Eigen::Isometry3d::Identity());
  if (result.size() != count)
    fields.fail(key, "expected " + counted(count, "pose") + ", one for each piece, got " +
                         std::to_string(result.size()));
  return result;
}

std::vector<ForeignSolid> ros_solids(const YamlFields& object, const std::string& name,
                                     const Eigen::Isometry3d& frame_from_object,
                                     const PackageFolders& packages, const std::filesystem::path& folder) {
  std::vector<ForeignSolid> solids;
  const auto add = [&](const Eigen::Isometry3d& object_from_shape) -> ForeignSolid& {
    ForeignSolid& solid = solids.emplace_back();
    solid.object = name;
    solid.map_from_shape = frame_from_object * object_from_shape;
    return solid;
  };
  const auto primitives = object.list_of_maps("primitives");
  const auto places = ros_poses(object, "primitive_poses", primitives.size());
  for (std::size_t i = 0; i < primitives.size(); ++i) read_primitive(primitives[i], add(places[i]));
  const auto meshes = object.list_of_maps("meshes");
  const auto places_of_meshes = ros_poses(object, "mesh_poses", meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    require_no_lost_keys(meshes[i], RosMessage::mesh);
    ForeignSolid& solid = add(places_of_meshes[i]);
    solid.kind = "mesh";
    solid.triangles =
        meshes[i].has("resource") ? mesh_of_resource(meshes[i], packages, folder) : mesh_inside(meshes[i]);
  }
  return solids;
}

RosAttached ros_attached(const YamlFields& state, const PackageFolders& packages,
                         const std::filesystem::path& folder) {
  RosAttached bodies;
  for (const YamlFields& entry : state.list_of_maps("attached_collision_objects")) {
    require_no_lost_keys(entry, RosMessage::attached_object);
    if (!entry.has("object")) entry.fail("object", "expected the object that is attached");
    const YamlFields object = entry.map("object");
    require_no_lost_keys(object, RosMessage::collision_object);
    const std::string operation = ros_operation(object);
    if (operation == "remove") {
      bodies.removed.push_back({ros_word(object, "id"), ros_word(entry, "link_name")});
      continue;
    }
    if (operation != "add" && operation != "append") {
      bodies.left_out.push_back("attached body " + quote(object.text("id")) +
                                ", which is not added (operation " + quote(operation) + ")");
      continue;
    }
    ForeignAttached& body = bodies.added.emplace_back();
    body.name = object.text("id");
    body.link = ros_word(entry, "link_name");
    body.touches = entry.texts("touch_links");
    body.weight = entry.number("weight", not_negative, 0.0);
    body.frame = ros_frame(object);
    const auto pose = object.has("pose") ? ros_pose(object.map("pose")) : Eigen::Isometry3d::Identity();
    body.pieces = ros_solids(object, body.name, pose, packages, folder);
    if (!object.list_of_maps("planes").empty())
      bodies.left_out.push_back("planes of attached body " + quote(body.name));
  }
  return bodies;
}

const std::string or_leave_out_frames = "; --leave-out-unknown-frames imports the rest";

void place_in_map(const SceneFrames& frames, ForeignAttached& body) {
  if (body.frame.empty())
    for (ForeignSolid& piece : body.pieces)
      piece.map_from_shape = frames.map_from_planning() * piece.map_from_shape;
}

std::string put_on_link(const SceneFrames& frames, ForeignAttached& body) {
  static const Eigen::Isometry3d map = Eigen::Isometry3d::Identity();
  if (body.frame == body.link || body.pieces.empty()) return "";
  const Eigen::Isometry3d* map_from_frame = body.frame.empty() ? &map : frames.find(body.frame);
  if (map_from_frame == nullptr) return frames.is_link(body.frame) ? "" : frames.why_unknown(body.frame);
  const Eigen::Isometry3d* map_from_link = frames.find(body.link);
  const Eigen::Isometry3d moved =
      map_from_link ? map_from_link->inverse() * *map_from_frame : *map_from_frame;
  for (ForeignSolid& piece : body.pieces) piece.map_from_shape = moved * piece.map_from_shape;
  body.frame = map_from_link ? body.link : "";
  return "";
}

}  // namespace clearway
