// Problem sets of robometrics and worlds of cuRobo.
#include <algorithm>
#include <array>
#include <set>

#include "apps/problem_sets/planning_scene.hpp"
#include "apps/problem_sets/scene_fields.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/geometry/turn_between.hpp"

namespace clearway {
namespace {

using Names = std::set<std::string>;

constexpr std::size_t most_set_nodes = 2'000'000;
constexpr Bounds lengths{tiny, 1e3}, places{-1e3, 1e3};

const Names obstacle_kinds{"cuboid", "cylinder", "sphere", "capsule", "mesh"};
const Names map_kinds{"blox", "voxel"};  ///< maps, in files of their own
const Names looks{"name",          "color",          "texture",     "texture_id", "material",
                  "vertex_colors", "vertex_normals", "face_colors", "tensor_args"};

/// Seven numbers: x, y, z and a quaternion w, x, y, z.
Eigen::Isometry3d pose_of(const YamlFields& fields, const std::string& position_key,
                          const std::vector<double>& position, const std::string& turn_key,
                          const std::vector<double>& wxyz) {
  const Eigen::Vector3d at(position[0], position[1], position[2]);
  const Eigen::Vector4d xyzw(wxyz[1], wxyz[2], wxyz[3], wxyz[0]);
  if (!(at.cwiseAbs().maxCoeff() <= 1e3)) fields.fail(position_key, "expected a place within 1000 metres");
  if (const std::string fault = unit_fault(xyzw, "w, x, y, z"); !fault.empty())
    fields.fail(turn_key, "expected " + fault);
  return pose_of_quaternion(at, xyzw);
}

Eigen::Isometry3d pose_of_obstacle(const YamlFields& obstacle) {
  const auto n = obstacle.numbers("pose", within_reach, 7);
  return pose_of(obstacle, "pose", {n[0], n[1], n[2]}, "pose", {n[3], n[4], n[5], n[6]});
}

/// `position` is the older key; where both are there they agree.
Eigen::Isometry3d place_of_sphere(const YamlFields& sphere) {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  if (sphere.has("pose")) place = pose_of_obstacle(sphere);
  if (!sphere.has("position")) {
    if (!sphere.has("pose")) sphere.fail("pose", "expected a pose of seven numbers");
    return place;
  }
  const auto n = sphere.numbers("position", places, 3);
  const Eigen::Vector3d at(n[0], n[1], n[2]);
  if (sphere.has("pose") && !(at - place.translation()).isZero(1e-6))
    sphere.fail("position", "expected the place that 'pose' has");
  place.translation() = at;
  return place;
}

/// From `base` to `tip`, which lie in the obstacle's frame.
void read_capsule(const YamlFields& capsule, ForeignSolid& solid) {
  const auto b = capsule.numbers("base", places, 3), t = capsule.numbers("tip", places, 3);
  const Eigen::Vector3d base(b[0], b[1], b[2]), tip(t[0], t[1], t[2]);
  const double radius = capsule.number("radius", lengths), length = (tip - base).norm();
  solid.shape = length > 0.0 ? Shape::capsule(radius, length) : Shape::sphere(radius);
  solid.map_from_shape.translate(0.5 * (base + tip));
  if (length > 0.0) solid.map_from_shape.rotate(turn_between(Eigen::Vector3d::UnitZ(), tip - base));
}

class SetReader {
 public:
  SetReader(const std::string& text, const std::filesystem::path& file, const SceneContext& context)
      : root_(text, "problem set " + quote_path(file.string()), YamlBounds{most_set_nodes, most_set_nodes}),
        file_(file),
        context_(context) {
    frames_.place_links(context_.robot, {});
  }

  ForeignSet read() {
    const auto keys = root_.keys();
    const bool is_world = std::any_of(keys.begin(), keys.end(), [](const std::string& key) {
      return obstacle_kinds.contains(key) || map_kinds.contains(key);
    });
    if (is_world) {
      ForeignWorld world{file_.stem().string(), {}};
      add_obstacles(root_, world);
      set_.worlds.push_back(std::move(world));
    } else {
      for (const std::string& name : keys) add_group(root_, name, name);
    }
    if (set_.problems.empty() && !first_fault_.empty()) throw std::invalid_argument(first_fault_);
    return std::move(set_);
  }

 private:
  void leave(const std::string& what) { set_.left_out.push_back(what); }

  /// A list of problems, or a map of such lists.
  void add_group(const YamlFields& groups, const std::string& key, const std::string& name) {
    if (!groups.has(key)) return;
    if (!groups.is_list(key)) {
      const YamlFields inner = groups.map(key);
      for (const std::string& part : inner.keys()) {
        if (inner.has(part) && !inner.is_list(part))
          inner.fail(part, "expected a list of problems, each with 'obstacles' and 'start'");
        add_group(inner, part, name + " " + part);
      }
      return;
    }
    std::size_t number = 0;
    for (const YamlFields& problem : groups.list_of_maps(key))
      try_problem(name, name + " " + std::to_string(++number), problem);
  }

  /// What cannot be read costs its problem, not the set.
  void try_problem(const std::string& experiment, const std::string& name, const YamlFields& problem) {
    const std::size_t left_out = set_.left_out.size();
    try {
      add_problem(experiment, name, problem);
    } catch (const std::invalid_argument& fault) {
      set_.left_out.resize(left_out);
      leave(name + ": " + fault.what());
      if (first_fault_.empty()) first_fault_ = fault.what();
    }
  }

  void add_problem(const std::string& experiment, const std::string& name, const YamlFields& problem) {
    static const Names known{"obstacles", "start",       "goal_ik",
                             "goal_pose", "world_frame", "collision_buffer_ik"};
    for (const std::string& key : problem.keys())
      if (problem.has(key) && !known.contains(key)) leave(name + ": " + quote(key));
    require_frame(problem);
    ForeignProblem ready{name, experiment, set_.worlds.size(), "", {}, {}};
    ready.start.values = problem.numbers("start", within_reach);
    if (ready.start.values.empty()) problem.fail("start", "expected joint values");
    if (problem.has("goal_ik"))
      for (auto& goal : problem.lists_of_numbers("goal_ik", within_reach, ready.start.values.size()))
        ready.goals.push_back({{{}, std::move(goal)}});
    if (problem.has("goal_pose")) ready.goals.push_back(goal_of(problem.map("goal_pose")));
    if (ready.goals.empty()) return leave(name + ": it has neither goal_ik nor goal_pose");
    ForeignWorld world{name, {}};
    if (!problem.has("obstacles")) problem.fail("obstacles", "expected a map of obstacles, or {}");
    add_obstacles(problem.map("obstacles"), world);
    set_.worlds.push_back(std::move(world));
    set_.problems.push_back(std::move(ready));
  }

  void require_frame(const YamlFields& problem) const {
    if (!problem.has("world_frame")) return;
    const std::string frame = problem.text("world_frame");
    const Eigen::Isometry3d* map_from_frame = frames_.find(frame);
    if (map_from_frame == nullptr)
      problem.fail("world_frame", "frame " + quote(frame) + ", " + frames_.why_unknown(frame));
    if (!map_from_frame->isApprox(Eigen::Isometry3d::Identity(), 1e-9))
      problem.fail("world_frame", "expected the robot's root, whose frame the map's is, got " + quote(frame));
  }

  static ForeignGoal goal_of(const YamlFields& pose) {
    ForeignGoal goal;
    goal.pose.emplace();
    goal.pose->link = pose.text("frame");
    goal.pose->pose.map_from_tip =
        pose_of(pose, "position_xyz", pose.numbers("position_xyz", within_reach, 3), "quaternion_wxyz",
                pose.numbers("quaternion_wxyz", within_reach, 4));
    return goal;
  }

  void add_obstacles(const YamlFields& obstacles, ForeignWorld& world) {
    for (const std::string& kind : obstacles.keys()) {
      if (!obstacles.has(kind)) continue;
      if (map_kinds.contains(kind)) {
        leave(world.name + ": its " + quote(kind) + ", which is a map of cuRobo's own");
        continue;
      }
      if (!obstacle_kinds.contains(kind))
        obstacles.fail(kind, "expected no such kind of obstacles, as they would be lost, or one of " +
                                 listed({obstacle_kinds.begin(), obstacle_kinds.end()}));
      if (obstacles.is_list(kind)) {
        for (const YamlFields& obstacle : obstacles.list_of_maps(kind))
          add_obstacle(kind, obstacle.text("name"), obstacle, world);
        continue;
      }
      const YamlFields named = obstacles.map(kind);
      for (const std::string& name : named.keys()) add_obstacle(kind, name, named.map(name), world);
    }
  }

  void add_obstacle(const std::string& kind, const std::string& name, const YamlFields& obstacle,
                    ForeignWorld& world) {
    ForeignSolid solid;
    solid.object = name;
    solid.kind = kind == "cuboid" ? "box" : kind;
    require_known(kind, obstacle);
    solid.map_from_shape = kind == "sphere" ? place_of_sphere(obstacle) : pose_of_obstacle(obstacle);
    if (kind == "cuboid") {
      const auto d = obstacle.numbers("dims", lengths, 3);
      solid.shape = Shape::box({d[0], d[1], d[2]});
    } else if (kind == "cylinder") {
      solid.shape = Shape::cylinder(obstacle.number("radius", lengths), obstacle.number("height", lengths));
    } else if (kind == "sphere") {
      solid.shape = Shape::sphere(obstacle.number("radius", lengths));
    } else if (kind == "capsule") {
      read_capsule(obstacle, solid);
    } else {
      solid.triangles = triangles_of(obstacle);
    }
    world.solids.push_back(std::move(solid));
  }

  /// Refuses a scale where it means nothing, and what nobody knows, as it may say where or how large it is.
  static void require_known(const std::string& kind, const YamlFields& obstacle) {
    static const std::map<std::string, Names> keys{{"cuboid", {"dims"}},
                                                   {"cylinder", {"radius", "height"}},
                                                   {"sphere", {"radius", "position"}},
                                                   {"capsule", {"radius", "base", "tip"}},
                                                   {"mesh", {"file_path", "urdf_path", "vertices", "faces"}}};
    for (const std::string& key : obstacle.keys()) {
      if (!obstacle.has(key) || key == "pose" || looks.contains(key) || keys.at(kind).contains(key)) continue;
      if (key != "scale")
        obstacle.fail(key, "expected no such key, as what it says would be lost, or one of pose, scale, " +
                               listed({keys.at(kind).begin(), keys.at(kind).end()}));
      const auto scale = obstacle.numbers("scale", lengths, 3);
      if (kind != "mesh" && scale != std::vector<double>(3, 1.0))
        obstacle.fail("scale", "expected 1, 1, 1, as cuRobo scales meshes alone");
    }
  }

  std::vector<Eigen::Vector3d> triangles_of(const YamlFields& mesh) const {
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
    if (mesh.has("scale")) {
      const auto n = mesh.numbers("scale", lengths, 3);
      scale = {n[0], n[1], n[2]};
    }
    if (mesh.has("file_path"))
      return mesh_of_file(mesh, "file_path", scale, context_.packages, file_.parent_path());
    auto corners = mesh_of_lists(mesh, "vertices", "faces");
    for (Eigen::Vector3d& corner : corners) corner = scale.cwiseProduct(corner);
    return corners;
  }

  const YamlFields root_;
  const std::filesystem::path& file_;
  const SceneContext& context_;
  SceneFrames frames_;
  ForeignSet set_;
  std::string first_fault_;
};

}  // namespace

ForeignSet read_robometrics(const std::string& text, const std::filesystem::path& file,
                            const SceneContext& context) {
  return SetReader(text, file, context).read();
}

}  // namespace clearway
