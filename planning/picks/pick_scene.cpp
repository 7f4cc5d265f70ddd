#include "planning/picks/pick_scene.hpp"

#include <cmath>

#include "mapping/maps/freed_voxels.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {
namespace {

constexpr double surely = 2e-6;  ///< m that an object reaches into its voxels, twice what the check asks

double lowest_point(const Shape& shape, const Eigen::Isometry3d& pose) {
  return shape.bounds(pose).min().z();
}

/// Calls `visit` with the centre of each voxel that meets the box.
template <class Visit>
void visit_voxels(const Eigen::AlignedBox3d& box, double edge, const Visit& visit) {
  const Eigen::Vector3d first = (box.min() / edge).array().floor(), last = (box.max() / edge).array().floor();
  for (double z = first.z(); z <= last.z(); ++z)
    for (double y = first.y(); y <= last.y(); ++y)
      for (double x = first.x(); x <= last.x(); ++x)
        visit(Eigen::Vector3d((x + 0.5) * edge, (y + 0.5) * edge, (z + 0.5) * edge));
}

Eigen::AlignedBox3d grown(Eigen::AlignedBox3d box, double by) {
  return {box.min().array() - by, box.max().array() + by};
}

}  // namespace

std::vector<Eigen::Vector3d> object_voxels(const Pick& pick, double resolution) {
  const Shape& shape = pick.object.shape;
  const double plane = lowest_point(shape, pick.map_from_object);
  std::vector<Eigen::Vector3d> voxels;
  visit_voxels(grown(shape.bounds(pick.map_from_object), pick.margin), resolution,
               [&](const Eigen::Vector3d& center) {
                 if (center.z() - resolution / 2 < plane - 0.5 * surely) return;
                 const double edge = resolution - (pick.margin > 0.0 ? 0.0 : 2.0 * surely);
                 const double away = distance_to_cube(shape, pick.map_from_object, center, edge).upper;
                 if (away <= std::max(0.0, pick.margin - surely)) voxels.push_back(center);
               });
  return voxels;
}

std::vector<Eigen::Vector3d> support_layer(const Shape& shape, const Eigen::Isometry3d& map_from_object,
                                           double resolution, double padding) {
  Eigen::AlignedBox3d box = grown(shape.bounds(map_from_object), layer_reach(resolution, padding));
  const double plane = lowest_point(shape, map_from_object);
  box.max().z() = plane + resolution;
  const Eigen::AlignedBox3d wide = grown(box, 0.5 * surely);
  std::vector<Eigen::Vector3d> voxels;
  visit_voxels(box, resolution, [&](const Eigen::Vector3d& center) {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(resolution / 2);
    if (wide.contains(Eigen::AlignedBox3d(center - half, center + half))) voxels.push_back(center);
  });
  return voxels;
}

PickScene::PickScene(const ConfigurationSpace& space, const Pick& pick,
                     const std::map<std::string, Policy>& load_policies)
    : space_(space),
      pick_(pick),
      load_policies_(load_policies),
      without_object_(with_free_voxels(space.map(), object_voxels(pick, space.map().resolution()), false)),
      load_(pick.object) {
  with_load(space.robot(), load_);
}

void PickScene::hold(const Eigen::Isometry3d& link_from_load, const std::optional<Configuration>& grasp) {
  constexpr double same = 5e-6;  // m, rad
  const bool is_there =
      carrying_ && (load_.link_from_load.matrix() - link_from_load.matrix()).cwiseAbs().maxCoeff() <= same;
  const bool is_held_alike =
      grasp_.has_value() == grasp.has_value() &&
      (!grasp || (carrying_ && grip_violation(carrying_->robot(), *grasp_, *grasp).empty()));
  if (is_there && is_held_alike) return;
  load_.link_from_load = link_from_load;
  grasp_ = grasp;
  carrying_.reset();
  lifting_.reset();
  lowering_.reset();
}

const ConfigurationSpace& PickScene::before() {
  return space_of(before_, with_standing(pick_.map_from_object, false), space_.map());
}
const ConfigurationSpace& PickScene::reaching() {
  if (pick_.grip.empty()) return grasping();
  return space_of(reaching_, with_core(with_standing(pick_.map_from_object, true)), without_object_);
}
const ConfigurationSpace& PickScene::grasping() {
  return space_of(grasping_, with_standing(pick_.map_from_object, true), without_object_);
}
const ConfigurationSpace& PickScene::bare() { return space_of(bare_, space_.robot(), without_object_); }
const ConfigurationSpace& PickScene::carrying() { return space_of(carrying_, loaded(), without_object_); }
const ConfigurationSpace& PickScene::lifting() {
  return space_of(lifting_, loaded(), without_layer(pick_.map_from_object));
}
const ConfigurationSpace& PickScene::lowering() {
  return space_of(lowering_, loaded(), without_layer(pick_.map_from_place));
}
const ConfigurationSpace& PickScene::releasing() {
  return space_of(releasing_, with_standing(pick_.map_from_place, true), without_object_);
}
const ConfigurationSpace& PickScene::retreating() {
  if (pick_.grip.empty()) return releasing();
  return space_of(retreating_, with_core(with_standing(pick_.map_from_place, true)), without_object_);
}
const ConfigurationSpace& PickScene::after() {
  return space_of(after_, with_standing(pick_.map_from_place, false), without_object_);
}

const ConfigurationSpace& PickScene::space_of(Kept& kept, const Robot& robot, const Snapshot& map) {
  if (kept) return *kept;
  Policies policies{.parts = space_.policies(), .other = Policy::not_occupied};
  const bool is_loaded = !robot.loads.empty();
  if (const auto given = load_policies_.find(load_.name); is_loaded && given != load_policies_.end())
    policies.parts.insert(*given);
  kept = std::make_unique<ConfigurationSpace>(robot, map, policies, space_.options());
  return *kept;
}

Robot PickScene::loaded() const {
  Robot robot = with_load(space_.robot(), load_);
  if (!grasp_) return robot;
  Robot still = with_still_grip(robot, *grasp_);
  for (std::size_t i = 0; i < still.joints.size(); ++i)
    if (Joint& joint = still.joints[i]; pick_.grip.contains(joint.name))
      joint.lower = joint.upper = (*grasp_)[static_cast<Eigen::Index>(i)];
  return still;
}

/// The object on the robot's root, which nothing moves.
Robot PickScene::with_standing(const Eigen::Isometry3d& map_from_object, bool may_be_touched) const {
  const Robot& robot = space_.robot();
  const Configuration any = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
  Load standing = pick_.object;
  if (may_be_touched)
    standing.touches.push_back(pick_.object.link);
  else
    standing.touches.clear();
  standing.link = robot.links.front().name;
  standing.link_from_load = forward_kinematics(robot, any).front().inverse() * map_from_object;
  return with_load(robot, standing);
}

/// With the middle of the object that stands there, which nothing may touch.
Robot PickScene::with_core(const Robot& robot) const {
  Load core = robot.loads.back();
  core.name = core_name(pick_);
  core.shape = *core_of(pick_);
  core.touches.clear();
  return with_load(robot, core);
}

Snapshot PickScene::without_layer(const Eigen::Isometry3d& map_from_object) const {
  const double edge = space_.map().resolution();
  return with_free_voxels(without_object_,
                          support_layer(pick_.object.shape, map_from_object, edge, space_.options().padding),
                          true);
}

}  // namespace clearway
