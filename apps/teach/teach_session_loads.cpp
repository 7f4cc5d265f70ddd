// What a session's robot carries: loads in its hand, and objects that strokes mark, picks take and put down.
#include <algorithm>
#include <stdexcept>

#include "apps/fusion/painter.hpp"
#include "apps/teach/teach_session.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/picks/pick_scene.hpp"
#include "planning/plan_pick.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_objects = 100;

/// Where a link of the robot is, map frame.
Eigen::Isometry3d map_from_link(const Robot& robot, const Configuration& q, const std::string& name) {
  const LinkPoses poses = forward_kinematics(robot, q);
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].name == name) return poses[i];
  throw std::invalid_argument("robot " + quote(robot.name) + " has no link " + quote(shortened(name)));
}

/// Whether a blocked voxel that leaves the map with the pick is another object's, too.
bool takes_from(const Pick& pick, const MarkedObject& other, const Snapshot& map) {
  const double edge = map.resolution();
  const std::vector<Eigen::Vector3d> voxels = object_voxels(pick, edge);
  return std::any_of(voxels.begin(), voxels.end(), [&](const Eigen::Vector3d& voxel) {
    const VoxelState state = map.state(voxel);
    if (state != VoxelState::occupied && state != VoxelState::conflict) return false;
    return distance_to_cube(other.load.shape, other.map_from_object, voxel, edge).lower <= 0.0;
  });
}

std::string size_text(const Shape& shape) {
  const Eigen::Vector3d size = shape.bounds(Eigen::Isometry3d::Identity()).sizes();
  return short_text(size.x(), 3) + " x " + short_text(size.y(), 3) + " x " + short_text(size.z(), 3) + " m";
}

}  // namespace

/// A leg carries what is held when its end is picked: that has to be free where it begins, too.
void TeachSession::require_begin(const TaughtPlace& begin) {
  if (choice_.held.empty()) return;
  const Verdict verdict = check(begin.q, choice_.held);
  if (!verdict.is_free())
    refuse("with " + names_of(choice_.held) +
           " the robot may not be where the leg begins: " + verdict.sentence());
}

void TeachSession::change_held(const std::string& what, std::vector<Load> held) {
  const bool had_plan = choice_.plan.has_value();
  choice_.held = std::move(held);
  const std::string outdated = choice_.outdated;
  forget_plan();
  choice_.outdated = had_plan ? what : outdated;
}

Load TeachSession::read_load_of(const TeachEvent& event) const {
  try {
    return load_of(event, *setup_);
  } catch (const DamagedFile& error) {  // its mesh, which the reading of events did not open
    refuse(error.what());
  }
}

void TeachSession::attach(const TeachEvent& event, std::string& remark) {
  require_robot();
  constexpr std::size_t most_loads = 16;
  Load load = read_load_of(event);
  if (choice_.pick)
    refuse(quote(choice_.pick->object.name) + " is picked, and nothing rides beside it; 'start' begins anew");
  for (const Load& known : choice_.held)
    if (known.name == load.name) refuse(quote(load.name) + " is attached already; 'detach' comes first");
  if (choice_.held.size() >= most_loads) refuse("at most 16 loads are possible; 'detach' one first");
  for (const TaughtPlace& place : goals())
    for (const Load& known : place.held) {
      if (known.name != load.name) continue;
      if (!is_same(known, load))
        refuse("another load " + quote(load.name) +
               " rides on a leg before; expected another name, or 'start' to begin anew");
      load = known;
    }
  std::vector<Load> held = choice_.held;
  held.push_back(load);
  const auto space = robot_->space(present_map(), map_version(), held);
  const TaughtPlace* begin = choice_.goal || !choice_.start ? nullptr
                             : choice_.vias.empty()         ? &*choice_.start
                                                            : &choice_.vias.back();
  if (begin != nullptr)
    if (const Verdict verdict = space->check(begin->q); !verdict.is_free())
      refuse("with " + quote(load.name) +
             " the robot may not be where the next leg begins: " + verdict.sentence());
  remember("attach");
  change_held(quote(load.name) + " was attached", std::move(held));
  remark = load.name + " on " + load.link;
}

void TeachSession::detach(const TeachEvent& event, std::string& remark) {
  if (choice_.held.empty()) refuse("nothing is attached; 'attach' takes a load");
  if (event.name.empty() && choice_.held.size() > 1)
    refuse("expected the name of a load, one of " + names_of(choice_.held));
  const std::string name = event.name.empty() ? choice_.held.front().name : event.name;
  std::vector<Load> held;
  for (const Load& load : choice_.held)
    if (load.name != name) held.push_back(load);
  if (held.size() == choice_.held.size())
    refuse("no load " + quote(shortened(name)) + " is attached; " + names_of(choice_.held) +
           (held.size() == 1 ? " is" : " are"));
  remember("detach");
  change_held(quote(name) + " was detached", std::move(held));
  remark = name;
}

void TeachSession::begin_object(const TeachEvent& event) {
  if (!setup_->probe) refuse("the setup has no probe");
  const std::string& name = event.name;
  for (const MarkedObject& known : choice_.objects)
    if (known.load.name == name)
      refuse("there is an object " + quote(name) + " already, expected another name");
  if (choice_.objects.size() >= most_objects)
    refuse("at most 100 objects are possible; 'undo' forgets the last");
  marked_ = {};
  marked_.load.name = name;
  marked_.load.link = event.link;
  marked_.load.mass = event.mass;
  marked_.load.touches = event.touches;
  Load any = marked_.load;
  if (robot_) {
    if (any.link.empty()) any.link = robot_->tip_link();
    with_load(robot_->robot(), any);  // what no robot of this kind can hold is reported now
  }
  balls_.clear();
  remember("object");
  doing_ = Doing::marking;
}

void TeachSession::mark(const PaintingSample& sample) {
  const Eigen::Isometry3d map_from_base = *fixed_board(*setup_, "teaching").map_from_board;
  balls_.push_back({map_from_base * sample.sphere.center, sample.sphere.radius, setup_->probe->ball_radius,
                    sample.bound.total});
}

void TeachSession::end_object(std::string& remark) {
  doing_ = Doing::nothing;
  try {
    const MarkedObject found = marked_object(balls_, map_->options().resolution);
    marked_.load.shape = found.load.shape;
    marked_.map_from_object = found.map_from_object;
  } catch (const std::invalid_argument& error) {
    undos_.pop_back();
    refuse(error.what());
  }
  choice_.objects.push_back(marked_);
  remark =
      marked_.load.name + ", " + size_text(marked_.load.shape) + " round " + counted(balls_.size(), "ball") +
      "; it stands at z = " + short_text(marked_.load.shape.bounds(marked_.map_from_object).min().z(), 3) +
      " m: what of it is lower is no part of it";
}

void TeachSession::require_own_voxels(const Pick& pick, const Snapshot& map) const {
  for (const MarkedObject& other : choice_.objects)
    if (other.load.name != pick.object.name && takes_from(pick, other, map))
      refuse("with " + quote(pick.object.name) + " voxels of " + quote(other.load.name) +
             " would leave the map; 'undo' back to their strokes and mark both again, the ball a voxel away "
             "from the other");
}

/// The grasp is where the virtual robot stands; that is free when the object's voxels are, and only what
/// holds it touches it.
void TeachSession::choose_pick(const TeachEvent& event, std::string& remark) {
  require_robot();
  if (!choice_.start) refuse("no start is chosen; 'start' comes first");
  if (!choice_.vias.empty()) refuse("a pick has no goals on the way; 'start' begins anew");
  if (choice_.goal && !choice_.goal->held.empty())
    refuse("the goal was chosen with " + names_of(choice_.goal->held) +
           ", and nothing rides beside what is picked; 'start' begins anew");
  if (!choice_.held.empty())
    refuse(names_of(choice_.held) +
           " rides already, and nothing rides beside what is picked; 'detach' comes first");
  if (choice_.objects.empty()) refuse("no object is marked; 'object' begins a stroke round one");
  if (event.name.empty() && choice_.objects.size() > 1) refuse("expected the name of an object");
  const auto object = std::find_if(
      choice_.objects.begin(), choice_.objects.end(),
      [&](const MarkedObject& known) { return event.name.empty() || known.load.name == event.name; });
  if (object == choice_.objects.end()) refuse("no object " + quote(shortened(event.name)) + " is marked");
  const Robot& robot = robot_->robot();
  const auto space = robot_->space(present_map(), map_version());
  const Configuration q = place_of(event);
  Pick pick;
  pick.object = object->load;
  if (pick.object.link.empty()) pick.object.link = robot_->tip_link();
  pick.map_from_object = pick.map_from_place = object->map_from_object;
  pick.object_from_tip = object->map_from_object.inverse() * tip_pose(robot, q);
  pick.approach = event.approach.value_or(robot.scale * pick.approach);
  pick.lift = event.lift.value_or(std::max(
      robot.scale * pick.lift, contact_length(pick, space->map().resolution(), space->options().padding)));
  pick.contact = event.contact.value_or(pick.contact);
  require_sound(pick, space->map().resolution(), space->options().padding);
  require_rigid_hold(robot, pick);
  require_own_voxels(pick, space->map());
  const Verdict verdict = PickScene(*space, pick, {}).grasping().check(q);
  if (!verdict.is_free()) refuse(verdict.sentence());
  remember("pick");
  choice_.pick = std::move(pick);
  choice_.grasp = q;
  choice_.place.reset();
  forget_plan();
  remark = choice_.pick->object.name;
}

/// The place is where the virtual robot, with the object in its hand as it was grasped, stands.
void TeachSession::choose_placing(const TeachEvent& event, std::string& remark) {
  require_robot();
  if (!choice_.pick) refuse("nothing is picked; 'pick' comes first");
  const Robot& robot = robot_->robot();
  const auto space = robot_->space(present_map(), map_version());
  const Configuration q = place_of(event);
  Pick pick = *choice_.pick;
  pick.map_from_place = tip_pose(robot, q) * pick.object_from_tip.inverse();
  PickScene scene(*space, pick, {});
  scene.hold(map_from_link(robot, *choice_.grasp, pick.object.link).inverse() * pick.map_from_object,
             *choice_.grasp);
  const Verdict verdict = scene.lowering().check(q);
  if (!verdict.is_free()) refuse(verdict.sentence());
  remember("place");
  choice_.pick = std::move(pick);
  choice_.place = q;
  forget_plan();
  const Eigen::Vector3d at = choice_.pick->map_from_place.translation();
  remark = choice_.pick->object.name + " at " + short_text(at.x(), 3) + ", " + short_text(at.y(), 3) + ", " +
           short_text(at.z(), 3);
}

std::vector<std::pair<const Load*, Eigen::Isometry3d>> TeachSession::standing_objects() const {
  std::vector<std::pair<const Load*, Eigen::Isometry3d>> standing;
  const bool is_played = doing_ == Doing::playing && !motion_.empty() && choice_.pick;
  for (const MarkedObject& object : choice_.objects) {
    const bool is_picked = is_played && object.load.name == choice_.pick->object.name;
    if (is_picked && !shown_loads().empty()) continue;
    constexpr std::size_t retreats = 5;  // legs from here on, as Pick lists them
    standing.emplace_back(&object.load, is_picked && played().leg >= retreats ? choice_.pick->map_from_place
                                                                              : object.map_from_object);
  }
  return standing;
}

}  // namespace clearway
