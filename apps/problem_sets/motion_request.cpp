#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "apps/problem_sets/own_names.hpp"
#include "apps/problem_sets/planning_scene.hpp"
#include "apps/problem_sets/scene_fields.hpp"
#include "datasets/yaml/message_keys.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr Bounds angles{0.0, 1e3};
constexpr double exact_within = 0.01;  ///< rad or m: MoveIt takes a robot so far beside a place to be there
constexpr double any_turn = std::numbers::pi - 1e-6;  ///< rad, a tolerance of more than that allows all

/// Half of the least extent of a region: the radius of the ball about its middle that lies in it.
double inner_radius(const ForeignSolid& region) {
  const Eigen::AlignedBox3d box = region.shape.bounds(Eigen::Isometry3d::Identity());
  return 0.5 * box.sizes().minCoeff();
}

/// The turns that tolerances about the axes of the goal's frame allow, from within: MoveIt bounds each of the
/// angles of x, then y, then z, or each coordinate of the turn's vector. Turns by an angle of at most the
/// least of them keep all. Beside a turn about a free axis they do so for z, the last, and for x, the first;
/// for a vector when they are 2/pi of it, as a half turn about one axis and a little one about another have
/// pi/2 times the little one in their vector.
void allow_turns(const Eigen::Array3d& tolerance, bool is_vector, GoalPose& goal) {
  double least = std::numbers::pi;
  for (const double about : tolerance)
    if (about < any_turn)
      least = std::min(least, is_vector ? about : std::min(about, 0.5 * std::numbers::pi));
  for (const int axis : {2, 0, 1})
    if (!goal.free_axis && tolerance[axis] >= any_turn && (is_vector || axis != 1)) goal.free_axis = axis;
  goal.turn_tolerance = least;
  if ((tolerance >= any_turn).all()) goal.free_axis.reset();
  if (goal.free_axis && is_vector) goal.turn_tolerance *= 2.0 / std::numbers::pi;
}

/// Goals of one request.
class GoalReader {
 public:
  GoalReader(const std::filesystem::path& file, const SceneFrames& frames, std::vector<std::string>& left_out)
      : file_(file), frames_(frames), left_out_(left_out) {}

  /// Adds a goal, or, where a position may be in any of several regions, one for each.
  /// @param number of the goal in the request
  void add(const YamlFields& goal, std::size_t number, std::vector<ForeignGoal>& goals) const {
    require_no_lost_keys(goal, RosMessage::constraints);
    if (!goal.list_of_maps("visibility_constraints").empty()) leave("visibility_constraints of a goal");
    ForeignGoal read;
    for (const YamlFields& joint : goal.list_of_maps("joint_constraints")) {
      require_no_lost_keys(joint, RosMessage::joint_constraint);
      const JointBand& band =
          read.bands.emplace_back(JointBand{joint.text("joint_name"), joint.number("position", within_reach),
                                            joint.number("tolerance_below", not_negative, 0.0),
                                            joint.number("tolerance_above", not_negative, 0.0)});
      read.joints.by_joint.emplace(band.joint, band.position);
    }
    tell_of_tolerances(read, number);
    if (goal.list_of_maps("position_constraints").empty() &&
        goal.list_of_maps("orientation_constraints").empty()) {
      if (read.has_joints()) goals.push_back(std::move(read));
      return;
    }
    for (ForeignPose& pose : poses_of(goal)) {
      read.pose = std::move(pose);
      goals.push_back(read);
    }
  }

 private:
  /// Goals of problems are configurations: a band of values becomes one of them (allowed_values).
  void tell_of_tolerances(const ForeignGoal& goal, std::size_t number) const {
    std::vector<std::string> wide;
    for (const JointBand& band : goal.bands)
      if (std::max(band.below, band.above) > exact_within &&
          std::find(wide.begin(), wide.end(), band.joint) == wide.end())
        wide.push_back(band.joint);
    if (!wide.empty())
      leave("tolerance_below and tolerance_above of goal_constraints[" + std::to_string(number) + "] for " +
            listed(wide) + ": its position alone is the goal, or the nearest that is allowed");
  }
  void leave(const std::string& what) const { left_out_.push_back(file_.filename().string() + ": " + what); }

  /// Where the frame of a constraint stands in the map at the start; none, reported: it is unknown.
  const Eigen::Isometry3d* frame_of(const YamlFields& constraint) const {
    const std::string frame = ros_frame(constraint);
    const Eigen::Isometry3d* known = frames_.find(frame);
    if (known == nullptr) leave("a goal in frame " + quote(frame) + ", " + frames_.why_unknown(frame));
    return known;
  }

  /// None, reported: the goal places no link, or says more than a pose does.
  std::vector<ForeignPose> poses_of(const YamlFields& goal) const {
    const auto positions = goal.list_of_maps("position_constraints");
    const auto turns = goal.list_of_maps("orientation_constraints");
    if (positions.empty()) {
      leave("a goal of an orientation " +
            std::string(goal.list_of_maps("joint_constraints").empty() ? "alone" : "and of joint values"));
      return {};
    }
    ForeignPose pose;
    pose.link = positions[0].text("link_name");
    if (positions.size() > 1 || turns.size() > 1 ||
        (!turns.empty() && turns[0].text("link_name") != pose.link)) {
      leave("a goal that places several links, or one link twice");
      return {};
    }
    pose.pose.turn_tolerance = std::numbers::pi;
    if (!turns.empty() && !set_turn(turns[0], pose)) return {};
    return at_positions(positions[0], std::move(pose));
  }

  /// The pose at each region of the constraint, as MoveIt takes any of them.
  std::vector<ForeignPose> at_positions(const YamlFields& constraint, ForeignPose pose) const {
    require_no_lost_keys(constraint, RosMessage::position_constraint);
    const Eigen::Isometry3d* map_from_frame = frame_of(constraint);
    if (map_from_frame == nullptr) return {};
    pose.point = ros_coordinates(constraint, "target_point_offset", "xyz");
    if (!constraint.has("constraint_region"))
      constraint.fail("constraint_region", "expected the region of the goal, with 'primitives'");
    const YamlFields region = constraint.map("constraint_region");
    require_no_lost_keys(region, RosMessage::region);
    const auto primitives = region.list_of_maps("primitives");
    if (primitives.empty()) {
      leave("a goal whose region is no box, sphere or cylinder");
      return {};
    }
    if (!region.list_of_maps("meshes").empty()) leave("meshes among the regions of a goal");
    const auto places = ros_poses(region, "primitive_poses", primitives.size());
    std::vector<ForeignPose> poses(primitives.size(), pose);
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      ForeignSolid solid;
      read_primitive(primitives[i], solid);
      poses[i].pose.map_from_tip.translation() = *map_from_frame * places[i].translation();
      poses[i].pose.position_tolerance = solid.kind == "cone" ? 0.0 : inner_radius(solid);
    }
    return poses;
  }

  bool set_turn(const YamlFields& constraint, ForeignPose& pose) const {
    require_no_lost_keys(constraint, RosMessage::orientation_constraint);
    const Eigen::Isometry3d* map_from_frame = frame_of(constraint);
    if (map_from_frame == nullptr) return false;
    pose.pose.map_from_tip.linear() = map_from_frame->linear() * ros_turn(constraint, "orientation");
    Eigen::Array3d tolerance;
    for (int axis = 0; axis < 3; ++axis)
      tolerance[axis] =
          constraint.number("absolute_" + std::string(1, "xyz"[axis]) + "_axis_tolerance", angles, 0.0);
    const std::string kind = constraint.has("parameterization") ? constraint.text("parameterization") : "0";
    if (kind != "0" && kind != "1")
      constraint.fail("parameterization",
                      "expected 0 (angles of x, y, z) or 1 (the turn's vector), got " + quote(kind));
    allow_turns(tolerance, kind == "1", pose.pose);
    return true;
  }

  const std::filesystem::path& file_;
  const SceneFrames& frames_;
  std::vector<std::string>& left_out_;
};

/// What the request says, and of other joints what its scene does, be it by other names.
std::map<std::string, double> start_of(const ForeignProblem& problem, const ForeignWorld& scene,
                                       const Robot& robot) {
  std::map<std::string, double> start = problem.start.by_joint;
  const OwnJoints own = own_joints(robot, start), left = own_joints(robot, scene.joints);
  for (const auto& [joint, value] : left.values)
    if (!own.values.contains(joint)) start.emplace(joint, value);
  return start;
}

/// A state that is no diff, and says where the robot stands, says all that is in its hand, as MoveIt has it.
void read_hand(const YamlFields& state, const std::filesystem::path& file, const SceneContext& context,
               const SceneFrames& frames, ForeignProblem& problem, std::vector<std::string>& left_out) {
  RosAttached bodies = ros_attached(state, context.packages, file.parent_path());
  for (const std::string& what : bodies.left_out) left_out.push_back(file.filename().string() + ": " + what);
  for (ForeignAttached& body : bodies.added) {
    place_in_map(frames, body);
    const std::string why = put_on_link(frames, body);
    if (!why.empty() && !context.leaves_unknown_frames)
      state.fail("attached_collision_objects", "attached body " + quote(body.name) + " stands in frame " +
                                                   quote(body.frame) + ", " + why + or_leave_out_frames);
  }
  problem.attached = std::move(bodies.added);
  problem.detached = std::move(bodies.removed);
  problem.keeps_attached = problem.start.by_joint.empty() || ros_truth(ros_word(state, "is_diff"));
}

}  // namespace

ForeignProblem read_motion_request(const std::string& text, const std::filesystem::path& file,
                                   const SceneContext& context, const ForeignWorld& scene,
                                   std::vector<std::string>& left_out) {
  const YamlFields request(text, "request " + quote_path(file.string()));
  for (const std::string& key : require_no_lost_keys(request, RosMessage::plan_request))
    left_out.push_back(file.filename().string() + ": key " + quote(key));
  ForeignProblem problem;
  problem.name = file.stem().string();
  problem.group = ros_word(request, "group_name");
  SceneFrames frames = scene.frames;
  if (request.has("start_state")) {
    const YamlFields state = request.map("start_state");
    require_base_of(frames, state);
    problem.start.by_joint = ros_joints(state);
    frames.place_links(context.robot, start_of(problem, scene, context.robot));
    read_hand(state, file, context, frames, problem, left_out);
  }
  const GoalReader reader(file, frames, left_out);
  std::size_t number = 0;
  for (const YamlFields& goal : request.list_of_maps("goal_constraints"))
    reader.add(goal, number++, problem.goals);
  if (request.has("path_constraints")) {
    const YamlFields path = request.map("path_constraints");
    for (const char* kind : {"joint_constraints", "position_constraints", "orientation_constraints"})
      if (!path.list_of_maps(kind).empty())
        left_out.push_back(file.filename().string() + ": " + kind + " of the path");
  }
  if (request.has("trajectory_constraints") &&
      !request.map("trajectory_constraints").list_of_maps("constraints").empty())
    left_out.push_back(file.filename().string() + ": trajectory_constraints");
  return problem;
}

}  // namespace clearway
