#include "datasets/ros/transform_faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "datasets/cameras/lower_case.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

void refuse_loop(const TransformTree& tree, const std::string& frame) {
  const std::vector<std::string> loop = tree.loop_above(frame);
  if (loop.empty()) return;
  std::string way = quote(loop.front());
  for (std::size_t i = 1; i < std::min<std::size_t>(loop.size(), 6); ++i) way += " in " + quote(loop[i]);
  throw ContradictoryBag("has transforms in a loop: " + way +
                         ", as of two publishers; expected a tree, with one parent of each frame");
}

std::string text_of(const FrameParent& parent) {
  return quote(parent.name) + " (" + std::to_string(parent.transforms) + " transforms)";
}

/// Of several parents only one may lead to the root: it is the one that is meant.
void refuse_parents(const TransformTree& tree, const std::string& root, const std::string& frame) {
  const std::vector<FrameParent> parents = tree.parents_of(frame, root);
  if (parents.size() < 2 || (parents[0].leads_to_root && !parents[1].leads_to_root)) return;
  const bool lead = parents[0].leads_to_root;
  throw ContradictoryBag("gives frame " + quote(frame) + " two parents, " + text_of(parents[0]) + " and " +
                         text_of(parents[1]) +
                         (lead ? ", and both lead to " : ", of which neither leads up to ") + quote(root) +
                         ": where it is cannot be told; expected a 'fixed_frame' to which one of the two "
                         "leads alone (as " +
                         quote(parents[0].name) + " itself), or `from` and `to` of a part with one of them");
}

void refuse_alternation(const TransformTree& tree, const std::string& frame) {
  const PoseConflicts conflicts = tree.conflicts_of(frame);
  if (!conflicts.are_many()) return;
  throw ContradictoryBag("has transforms that contradict each other: " + std::to_string(conflicts.count()) +
                         " of " + counted(conflicts.poses, "pose") + " of frame " + quote(frame) +
                         " are up to " + short_text(conflicts.farthest) +
                         " m away from others of their time, as of two publishers, two runs or a clock that "
                         "was set back; expected "
                         "one publisher of each frame");
}

/// The root drives in the frames above it, and all sensors stand still in it: as on a robot, whose own frame
/// is no place for a map. Empty: it is not so.
std::string driven_root(const TransformTree& tree, const std::string& root,
                        const std::set<std::string>& sensors) {
  constexpr double still = 0.02, far = 0.1;  // m
  for (const std::string& frame : used_frames(tree, root, sensors))
    if (tree.way_of(frame) > still) return "";
  const std::vector<std::string> chain = tree.chain_of(root);
  // The first one above that moves; a robot that finds out where it is lets its odometry's frame jump.
  const auto moving = std::find_if(chain.begin(), chain.end(),
                                   [&](const std::string& frame) { return tree.way_of(frame) > still; });
  if (moving == chain.end() || sensors.empty()) return "";
  const double way = tree.way_of(*moving);
  if (way <= far || tree.longest_step_of(*moving) > 0.5 * way) return "";
  return "has frame " + quote(root) + ", in which all is placed, move by " + short_text(way, 3) + " m in " +
         quote(chain.back()) +
         ", and its sensors stand still in it: what they saw from different places lies " +
         "one over the other; expected `fixed_frame` to be " + quote(chain.back()) +
         " if that is the world's";
}

}  // namespace

std::set<std::string> used_frames(const TransformTree& tree, const std::string& root,
                                  const std::set<std::string>& sensors) {
  std::set<std::string> frames;
  for (const std::string& sensor : sensors) frames.merge(tree.way_between(root, sensor));
  return frames;
}

bool is_driven_in(const TransformTree& tree, const std::string& root, const std::string& frame) {
  double own = 0.1;  // m, what is not worth a word
  for (const std::string& link : tree.way_between(root, frame)) own += tree.way_of(link);
  for (const BagFrame& below : tree.edges()) {
    const std::vector<std::string> chain = tree.chain_of(below.name);
    const bool is_below = std::find(chain.begin(), chain.end(), frame) != chain.end();
    if (is_below && below.name != frame && tree.way_of(below.name) > own) return true;
  }
  return false;
}

bool is_start_name(const std::string& frame) { return frame == "odom" || frame == "camera_init"; }

bool is_world_name(const std::string& frame) {
  return frame == "map" || frame == "world" || frame == "earth";
}

bool is_body_name(const std::string& frame) {
  constexpr std::array names{
      "base",        "base_link", "baselink", "base_footprint", "base_stabilized", "base_frame",
      "body",        "body_link", "chassis",  "chassis_link",   "vehicle",         "ego",
      "ego_vehicle", "hero",      "car",      "robot",          "platform",        "torso",
      "torso_link",  "trunk",     "pelvis",   "drone",          "vehicle_link",    "uav"};
  const std::string whole = lower_case(frame), last = whole.substr(whole.rfind('/') + 1);
  return std::any_of(names.begin(), names.end(), [&](const char* name) {
    return last == name || last.ends_with("_" + std::string(name));
  });
}

bool is_sensor_name(const std::string& frame) {
  constexpr std::array parts{"lidar", "laser", "velo",   "vlp",  "ouster", "livox", "hesai", "pandar",
                             "robos", "rslid", "sick",   "lms",  "hokuyo", "scan",  "radar", "cam",
                             "depth", "optic", "kinect", "real", "zed",    "sensor"};
  const std::string name = lower_case(frame);
  return !is_body_name(frame) && std::any_of(parts.begin(), parts.end(), [&](const char* part) {
    return name.find(part) != std::string::npos;
  });
}

MountedFrames mounted_on(const TransformTree& tree, const std::string& frame, double time, double recorded) {
  constexpr double beside = 0.1;  // m: what is nearer is as good as there
  MountedFrames mounted;
  for (const BagFrame& below : tree.edges()) {
    const std::vector<std::string> chain = tree.chain_of(below.name);
    if (below.name == frame || std::find(chain.begin(), chain.end(), frame) == chain.end()) continue;
    const auto pose = tree.root_from_frame(frame, below.name, time, recorded);
    if (!pose || !(pose->translation().norm() > beside)) continue;
    const bool is_sensor = is_sensor_name(below.name);
    if (mounted.are_sensors && !is_sensor) continue;
    if (is_sensor && !mounted.are_sensors) mounted = {{}, 0.0, true};
    if (mounted.names.empty() || mounted.names.back() != below.name) mounted.names.push_back(below.name);
    mounted.farthest = std::max(mounted.farthest, pose->translation().norm());
  }
  return mounted;
}

void refuse_contradictions(const TransformTree& tree, const std::string& root,
                           const std::set<std::string>& sensors) {
  for (const std::string& sensor : sensors) refuse_loop(tree, sensor);
  refuse_loop(tree, root);
  for (const std::string& frame : used_frames(tree, root, sensors)) {
    refuse_parents(tree, root, frame);
    refuse_alternation(tree, frame);
  }
}

std::vector<std::string> tell_contradictions(const TransformTree& tree, const std::string& root,
                                             const std::set<std::string>& sensors) {
  std::vector<std::string> clauses;
  if (const std::string driven = driven_root(tree, root, sensors); !driven.empty()) clauses.push_back(driven);
  for (const std::string& frame : used_frames(tree, root, sensors)) {
    const PoseConflicts conflicts = tree.conflicts_of(frame);
    if (conflicts.same_time > 0)
      clauses.push_back("holds " + std::to_string(conflicts.same_time) + " of " +
                        counted(conflicts.poses, "pose") + " of frame " + quote(frame) +
                        " that contradict others of the same time, by up to " +
                        short_text(conflicts.farthest) + " m; the last one counts");
    if (const std::size_t changes = tree.changes_of(frame); changes > 0)
      clauses.push_back("moves the fixed frame " + quote(frame) + " " + std::to_string(changes) +
                        (changes == 1 ? " time" : " times") +
                        " in /tf_static; each pose holds from its recording on");
  }
  std::string last;
  for (const BagFrame& edge : tree.edges()) {
    const std::vector<FrameParent> parents = tree.parents_of(edge.name, root);
    if (parents.size() < 2 || std::exchange(last, edge.name) == edge.name) continue;
    clauses.push_back("gives frame " + quote(edge.name) + " two parents, " + text_of(parents[0]) + " and " +
                      text_of(parents[1]) + "; the first one counts" +
                      (parents[0].leads_to_root ? ", which leads to " + quote(root) : ""));
  }
  return clauses;
}

std::string tell_moving_base(const TransformTree& tree, const std::string& root, const std::string& base) {
  constexpr double still = 0.02;  // m, rad
  double way = 0.0, turn = 0.0;
  for (const std::string& frame : tree.way_between(root, base)) {
    way += tree.way_of(frame);
    turn += tree.turn_of(frame);
  }
  if (way <= still && turn <= still) return "";
  return "moves the base of the robot, frame " + quote(base) + ", by up to " + short_text(way, 3) +
         " m and " + short_text(turn, 3) + " rad in " + quote(root) +
         ", but `robot` is taken to stand at its `base`: while it was elsewhere, its points are in the map, "
         "and things where it is taken to be are not; `from` and `to` of `source: {bag: …}` take a part in "
         "which it stands";
}

}  // namespace clearway
