#include "apps/problem_sets/planning_scene.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>

#include "apps/problem_sets/scene_fields.hpp"
#include "apps/problem_sets/scene_octomap.hpp"
#include "datasets/yaml/message_keys.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_objects = 100'000;

std::string called(const std::filesystem::path& file) { return quote_path(file.string()); }

/// What moveit_msgs/AllowedCollisionMatrix allows to collide of scene objects and what is none, and of bodies
/// in the hand and links.
struct AllowedPairs {
  AllowedPairs(const YamlFields& matrix, const std::set<std::string>& objects) {
    const auto names = matrix.texts("entry_names");
    const auto rows = matrix.lists_of_texts("entry_values", "enabled");
    const auto allows = [&](std::size_t i, std::size_t k) {
      return i < rows.size() && k < rows[i].size() && ros_truth(rows[i][k]);
    };
    std::vector<bool> is_object;
    for (const std::string& name : names) is_object.push_back(objects.contains(name));
    for (std::size_t i = 0; i < names.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) {
        if (!allows(i, k) && !allows(k, i)) continue;
        if (!allows(i, k) || !allows(k, i)) {  // which side counts differs between programs
          one_sided.emplace_back(names[k], names[i]);
          continue;
        }
        with[names[i]].push_back(names[k]);
        with[names[k]].push_back(names[i]);
        if (is_object[i] != is_object[k])
          of_objects.emplace_back(names[is_object[i] ? i : k], names[is_object[i] ? k : i]);
      }
    const auto defaults = matrix.texts("default_entry_names"), values = matrix.texts("default_entry_values");
    for (std::size_t i = 0; i < std::min(defaults.size(), values.size()); ++i)
      if (objects.contains(defaults[i]) && ros_truth(values[i])) by_default.push_back(defaults[i]);
  }

  std::map<std::string, std::vector<std::string>> with;  ///< of each name those that it may collide with
  std::vector<std::pair<std::string, std::string>> of_objects;  ///< an object, and what is none
  std::vector<std::pair<std::string, std::string>> one_sided;   ///< allowed by one of the two entries alone
  std::vector<std::string> by_default;  ///< objects that may collide with whatever no pair names
};

/// An entry of fixed_frame_transforms.
struct FixedFrame {
  YamlFields entry;
  std::string header, child;
  Eigen::Isometry3d pose;
};

class SceneReader {
 public:
  SceneReader(const std::string& text, const std::filesystem::path& file, const SceneContext& context,
              std::vector<std::string>& left_out)
      : scene_(text, "scene " + called(file)), file_(file), context_(context), left_out_(left_out) {}

  ForeignWorld read() {
    world_.name = file_.stem().string();
    leave_keys(require_no_lost_keys(scene_, RosMessage::planning_scene));
    if (scene_.has("robot_state")) {
      base_ = ros_base(scene_.map("robot_state"));
      world_.joints = ros_joints(scene_.map("robot_state"));
    }
    read_frames();
    if (base_) {
      require_base_of(frames_, scene_.map("robot_state"));
      if (!base_->pose.linear().col(2).isApprox(Eigen::Vector3d::UnitZ(), 1e-6))
        leave("that its base is tilted: costs and torques are reckoned with gravity along the base's -z");
    }
    if (scene_.has("world")) read_world(scene_.map("world"));
    if (scene_.has("robot_state")) add_attached(scene_.map("robot_state"));
    place_objects();
    leave_robot_name();
    take_allowed_pairs();
    leave_link_sizes("link_padding", "padding", 0.0);
    leave_link_sizes("link_scale", "scale", 1.0);
    world_.frames = std::move(frames_);
    return std::move(world_);
  }

 private:
  void leave(const std::string& what) { left_out_.push_back(file_.filename().string() + ": " + what); }

  void leave_keys(const std::vector<std::string>& unknown, const std::string& whose = "") {
    for (const std::string& key : unknown) leave("key " + quote(key) + whose);
  }

  void read_world(const YamlFields& world) {
    leave_keys(require_no_lost_keys(world, RosMessage::scene_world), " of its world");
    if (world.has("octomap")) add_octomap(world.map("octomap"));
    const auto objects = world.list_of_maps("collision_objects");
    if (objects.size() > most_objects) world.fail("collision_objects", "expected at most 100000 of them");
    for (const YamlFields& object : objects) add_object(object);
  }

  /// Links first, where the scene has the robot, then frames that are placed in themselves, which are the
  /// planning frame, then all that hang on a known one.
  void read_frames() {
    frames_ = SceneFrames(context_.planning_frames, base_ ? base_->pose : Eigen::Isometry3d::Identity());
    frames_.place_links(context_.robot, world_.joints);
    std::vector<FixedFrame> others;
    for (const YamlFields& entry : scene_.list_of_maps("fixed_frame_transforms")) {
      require_no_lost_keys(entry, RosMessage::transform_stamped);
      if (!entry.has("transform")) continue;
      FixedFrame frame{entry, ros_frame(entry), ros_word(entry, "child_frame_id"),
                       ros_transform(entry.map("transform"))};
      if (frame.child.starts_with('/')) frame.child.erase(0, 1);
      if (frame.header != frame.child)
        others.push_back(std::move(frame));
      else if (frame.pose.isApprox(Eigen::Isometry3d::Identity(), 1e-9))
        frames_.add_planning_frame(frame.header);
      else
        entry.fail("transform", "expected none that moves frame " + quote(frame.header) + " against itself");
    }
    drop_repeated(others);
    for (bool is_named = true; !others.empty();) {
      const std::size_t before = others.size();
      std::erase_if(others, [&](const FixedFrame& frame) { return is_placed(frame, is_named); });
      if (others.size() == before && !is_named) break;
      is_named = others.size() < before;
    }
  }

  /// Of several transforms between the same two frames one stays; they must agree.
  static void drop_repeated(std::vector<FixedFrame>& frames) {
    std::map<std::pair<std::string, std::string>, Eigen::Isometry3d> known;
    std::erase_if(frames, [&](const FixedFrame& frame) {
      const auto [first, is_new] = known.emplace(std::pair(frame.header, frame.child), frame.pose);
      if (!is_new && !first->second.isApprox(frame.pose, 1e-9))
        frame.entry.fail("transform", "expected one transform between frames " + quote(frame.header) +
                                          " and " + quote(frame.child) + ", got two that differ");
      return !is_new;
    });
  }

  /// MoveIt calls the frame that it places `header`, and the known one that it is placed in `child`; where
  /// only the other one is known, the names mean what tf means by them.
  bool is_placed(const FixedFrame& frame, bool is_named) {
    const bool is_usual = frames_.find(frame.child, is_named) != nullptr;
    const std::string& placed = is_usual ? frame.header : frame.child;
    const Eigen::Isometry3d* known = frames_.find(is_usual ? frame.child : frame.header, is_named);
    if (known == nullptr) return false;
    const Eigen::Isometry3d pose = *known * frame.pose;
    const Eigen::Isometry3d* other = frames_.find(placed, is_named);
    if (other == nullptr)
      frames_.place(placed, pose);
    else if (!other->isApprox(pose, 1e-9))
      frame.entry.fail("transform", "expected none for frame " + quote(placed) +
                                        ", which is the map's own or stands elsewhere by another transform");
    return true;
  }

  void add_octomap(const YamlFields& octomap) {
    require_no_lost_keys(octomap, RosMessage::octomap_with_pose);
    if (!octomap.has("octomap")) return;
    const Eigen::Isometry3d origin =
        octomap.has("origin") ? ros_pose(octomap.map("origin")) : Eigen::Isometry3d::Identity();
    std::optional<ForeignSolid> solid = read_octomap(octomap.map("octomap"), origin);
    if (!solid) return;
    const std::optional<Eigen::Isometry3d> map_from_frame = frame_of(octomap, "its octomap");
    if (!map_from_frame) return;
    solid->map_from_shape = *map_from_frame * origin;
    world_.solids.push_back(std::move(*solid));
  }

  /// Where the frame of an object's header stands. None, reported: it is unknown, which the context allows.
  std::optional<Eigen::Isometry3d> frame_of(const YamlFields& object, const std::string& name) {
    const std::string frame = ros_frame(object);
    if (const Eigen::Isometry3d* known = frames_.find(frame)) return *known;
    if (const auto of_object = frame_of_object(frame)) return of_object;
    const std::string what = name + " in frame " + quote(frame) + ", ";
    if (!context_.leaves_unknown_frames)
      object.fail("header", what + frames_.why_unknown(frame) + or_leave_out_frames);
    leave(what + "which is not the map's");
    return std::nullopt;
  }

  /// Where an object that is there stands, or a subframe of it, OBJECT/SUBFRAME; as MoveIt has it.
  std::optional<Eigen::Isometry3d> frame_of_object(const std::string& frame) const {
    if (const auto known = poses_.find(frame); known != poses_.end()) return known->second;
    for (const auto& [object, pose] : poses_) {
      const auto frames = subframes_.find(object);
      if (frames == subframes_.end() || !frame.starts_with(object + "/")) continue;
      if (const auto known = frames->second.find(frame.substr(object.size() + 1));
          known != frames->second.end())
        return pose * known->second;
    }
    return std::nullopt;
  }

  /// Requests may name them, too.
  void place_objects() {
    for (const auto& [object, pose] : poses_) {
      if (frames_.find(object) == nullptr) frames_.place(object, pose);
      for (const auto& [name, in_object] : subframes_[object])
        if (const std::string frame = object + "/" + name; frames_.find(frame) == nullptr)
          frames_.place(frame, pose * in_object);
    }
  }

  void take_subframes(const YamlFields& object, const std::string& name) {
    const std::vector<std::string> names = object.texts("subframe_names");
    if (names.empty()) return;
    const auto places = ros_poses(object, "subframe_poses", names.size());
    for (std::size_t i = 0; i < names.size(); ++i) subframes_[name].insert_or_assign(names[i], places[i]);
  }

  /// Bodies in the hand. One without shapes is the world's object of its name, which is no obstacle then, as
  /// MoveIt has it.
  void add_attached(const YamlFields& state) {
    RosAttached bodies = ros_attached(state, context_.packages, file_.parent_path());
    for (const std::string& what : bodies.left_out) leave(what);
    for (ForeignAttached& body : bodies.added) {
      if (body.pieces.empty()) {
        const auto is_taken = [&](const ForeignSolid& solid) { return solid.object == body.name; };
        std::copy_if(world_.solids.begin(), world_.solids.end(), std::back_inserter(body.pieces), is_taken);
        std::erase_if(world_.solids, is_taken);
        objects_.erase(body.name);
        poses_.erase(body.name);
        body.frame.clear();
      } else {
        place_in_map(frames_, body);
      }
      const std::string why = put_on_link(frames_, body);
      if (!why.empty() && !context_.leaves_unknown_frames)
        state.fail("attached_collision_objects", "attached body " + quote(body.name) + " stands in frame " +
                                                     quote(body.frame) + ", " + why + or_leave_out_frames);
      world_.attached.push_back(std::move(body));
    }
  }

  void leave_robot_name() {
    const std::string name = ros_word(scene_, "robot_model_name");
    if (name.empty() || context_.robot.name.empty()) return;
    if (name == context_.robot.name || name == context_.robot.model) return;
    leave("its robot_model_name, " + quote(name) + ", which is not the robot's name");
  }

  /// Notes that the link may touch the object, if it is a link, and the object of shapes and meshes alone.
  bool may_touch(const std::string& object, const std::string& link) {
    const std::vector<Link>& links = context_.robot.links;
    if (std::none_of(links.begin(), links.end(), [&](const Link& own) { return own.name == link; }))
      return false;
    bool has_solids = false;
    for (const ForeignSolid& solid : world_.solids) {
      if (solid.object != object) continue;
      if (solid.kind == "plane" || solid.kind == "octomap") return false;
      has_solids = true;
    }
    if (has_solids) world_.touched[object].push_back(link);
    return has_solids;
  }

  /// Links may touch what is in the hand, and the objects, with which these pairs name them; pairs of links
  /// are the SRDF's, and those of objects say nothing of the robot.
  void take_allowed_pairs() {
    if (!scene_.has("allowed_collision_matrix")) return;
    const AllowedPairs pairs(scene_.map("allowed_collision_matrix"), objects_);
    for (ForeignAttached& body : world_.attached)
      if (const auto links = pairs.with.find(body.name); links != pairs.with.end())
        body.touches.insert(body.touches.end(), links->second.begin(), links->second.end());
    std::vector<std::string> left;
    for (const auto& [object, other] : pairs.of_objects)
      if (!may_touch(object, other)) left.push_back(quote(object) + " with " + quote(other));
    if (!left.empty())
      leave("its allowed_collision_matrix: " + std::to_string(left.size()) +
            " pairs with an object that may collide, the first " + left.front());
    if (!pairs.one_sided.empty())
      leave("its allowed_collision_matrix: " + counted(pairs.one_sided.size(), "pair") +
            " that one of its two entries alone allows, the first " + quote(pairs.one_sided.front().first) +
            " with " + quote(pairs.one_sided.front().second));
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

  static bool is_piece_of(const ForeignSolid& solid, const std::string& name) {
    return solid.object == name && solid.kind != "octomap";
  }

  void add_object(const YamlFields& object) {
    leave_keys(require_no_lost_keys(object, RosMessage::collision_object),
               " of object " + quote(ros_word(object, "id")));
    const std::string operation = ros_operation(object);
    if (operation == "remove") return remove_object(object);
    const std::string name = object.text("id");
    objects_.insert(name);
    if (operation == "move") return move_object(object, name);
    const auto planes = object.list_of_maps("planes");
    if (object.list_of_maps("primitives").empty() && object.list_of_maps("meshes").empty() && planes.empty())
      return leave("object " + quote(name) + ", which has neither primitives nor meshes");
    const std::optional<Eigen::Isometry3d> map_from_frame = frame_of(object, "object " + quote(name));
    if (!map_from_frame) return;
    if (operation == "add") forget_object(name);  // in place of the one of its name, as MoveIt has it
    const Eigen::Isometry3d map_from_object =
        *map_from_frame * (object.has("pose") ? ros_pose(object.map("pose")) : Eigen::Isometry3d::Identity());
    const std::size_t before = world_.solids.size();
    auto solids = ros_solids(object, name, map_from_object, context_.packages, file_.parent_path());
    std::move(solids.begin(), solids.end(), std::back_inserter(world_.solids));
    const auto places = ros_poses(object, "plane_poses", planes.size());
    for (std::size_t i = 0; i < planes.size(); ++i) {
      ForeignSolid& solid = world_.solids.emplace_back(ForeignSolid{name, "plane"});
      solid.map_from_shape = map_from_object * places[i];
      require_no_lost_keys(planes[i], RosMessage::plane);
      const auto plane = planes[i].numbers("coef", within_reach, 4);
      planes_[name].emplace_back(plane[0], plane[1], plane[2], plane[3]);
      spread(solid, planes_[name].back());
      if (solid.triangles.empty())
        planes[i].fail("coef", "expected a b c d with a normal a b c that is not 0");
    }
    // The pose of a single piece is the object's where that has none, as MoveIt has it.
    const bool is_alone =
        world_.solids.size() == before + 1 && map_from_object.isApprox(*map_from_frame, 1e-12);
    poses_.emplace(name, is_alone ? world_.solids.back().map_from_shape : map_from_object);
    take_subframes(object, name);
  }

  void spread(ForeignSolid& solid, const Eigen::Vector4d& plane) const {
    solid.triangles =
        plane_triangles(plane, solid.map_from_shape.inverse().translation(), context_.plane_reach);
  }

  void forget_object(const std::string& name) {
    std::erase_if(world_.solids, [&](const ForeignSolid& solid) { return is_piece_of(solid, name); });
    planes_.erase(name);
    poses_.erase(name);
    subframes_.erase(name);
  }

  /// The object of this name, or all, but for the octomap, without a name.
  void remove_object(const YamlFields& object) {
    const std::string name = ros_word(object, "id");
    if (!name.empty() && !poses_.contains(name))
      return leave("the removal of object " + quote(name) + ", which is not there");
    const std::map<std::string, Eigen::Isometry3d> known = poses_;
    for (const auto& [other, pose] : known) {
      if (!name.empty() && other != name) continue;
      forget_object(other);
      objects_.erase(other);
    }
  }

  /// To another pose, with its pieces, which may get other places in it, first primitives, then meshes and
  /// planes. What the message says of shapes does not count.
  void move_object(const YamlFields& object, const std::string& name) {
    const auto known = poses_.find(name);
    if (known == poses_.end()) return leave("the move of object " + quote(name) + ", which is not there");
    const std::optional<Eigen::Isometry3d> map_from_frame = frame_of(object, "object " + quote(name));
    if (!map_from_frame) return;
    const Eigen::Isometry3d moved =
        *map_from_frame * (object.has("pose") ? ros_pose(object.map("pose")) : Eigen::Isometry3d::Identity());
    std::vector<ForeignSolid*> pieces;
    for (ForeignSolid& solid : world_.solids)
      if (is_piece_of(solid, name)) pieces.push_back(&solid);
    std::vector<Eigen::Isometry3d> places;
    for (const char* key : {"primitive_poses", "mesh_poses", "plane_poses"})
      for (const YamlFields& pose : object.list_of_maps(key)) places.push_back(ros_pose(pose));
    if (!places.empty() && places.size() != pieces.size())
      object.fail("operation", "expected a move of object " + quote(name) + " with no poses of pieces, or " +
                                   std::to_string(pieces.size()) + ", one for each, got " +
                                   std::to_string(places.size()));
    std::size_t plane = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      ForeignSolid& piece = *pieces[i];
      const Eigen::Isometry3d in_object =
          places.empty() ? known->second.inverse() * piece.map_from_shape : places[i];
      piece.map_from_shape = moved * in_object;
      if (piece.kind == "plane") spread(piece, planes_[name][plane++]);
    }
    known->second = moved;
  }

  YamlFields scene_;
  const std::filesystem::path& file_;
  const SceneContext& context_;
  std::vector<std::string>& left_out_;
  std::optional<RosBase> base_;
  SceneFrames frames_;
  std::set<std::string> objects_;                               ///< names
  std::map<std::string, Eigen::Isometry3d> poses_;              ///< of objects with pieces, in the map
  std::map<std::string, std::vector<Eigen::Vector4d>> planes_;  ///< of objects, in the order of their pieces
  std::map<std::string, std::map<std::string, Eigen::Isometry3d>> subframes_;  ///< of objects, in these
  ForeignWorld world_;
};

}  // namespace

SceneFileKind kind_of_scene_file(const std::string& text, const std::filesystem::path& file) {
  const YamlFields fields(text, "file " + called(file));
  if (fields.has("world")) return SceneFileKind::scene;
  if (fields.has("goal_constraints") || fields.has("start_state")) return SceneFileKind::request;
  // A moveit_msgs/PlanningScene may have no world.
  return has_keys_of(fields, RosMessage::planning_scene) ? SceneFileKind::scene : SceneFileKind::neither;
}

ForeignWorld read_planning_scene(const std::string& text, const std::filesystem::path& file,
                                 const SceneContext& context, std::vector<std::string>& left_out) {
  return SceneReader(text, file, context, left_out).read();
}

}  // namespace clearway
