#include "apps/query/loads.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/query/query.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/robot_files/mesh_file.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

Shape mesh_shape(const LoadMesh& mesh, const std::string& what) {
  const MeshHull hull = read_mesh_hulls({{mesh.file, Eigen::Vector3d::Constant(mesh.scale)}}).front();
  if (hull.is_damaged) throw DamagedFile(what + ": " + hull.failure);
  if (!hull.failure.empty()) throw std::invalid_argument(what + ": " + hull.failure);
  return Shape::convex(hull.corners);
}

}  // namespace

Shape load_shape(const LoadShape& shape, const std::string& what) {
  if (const auto* box = std::get_if<LoadBox>(&shape)) return Shape::box(box->edges);
  if (const auto* round = std::get_if<LoadCylinder>(&shape))
    return Shape::cylinder(round->radius, round->length);
  if (const auto* round = std::get_if<LoadCapsule>(&shape))
    return Shape::capsule(round->radius, round->length);
  if (const auto* sphere = std::get_if<LoadSphere>(&shape)) return Shape::sphere(sphere->radius);
  if (const auto* hull = std::get_if<LoadHull>(&shape)) return Shape::convex(hull->points);
  return mesh_shape(std::get<LoadMesh>(shape), what);
}

LegLoad leg_load(const LoadSetup& setup) {
  LegLoad load;
  load.load = {setup.name, setup.link,   setup.link_from_load, load_shape(setup.shape, "load " + setup.name),
               setup.mass, setup.touches};
  for (const int leg : setup.legs) load.legs.push_back(leg - 1);
  return load;
}

std::vector<LegLoad> choose_loads(const std::vector<std::filesystem::path>& files, const Robot& robot) {
  std::vector<LegLoad> loads;
  for (const std::filesystem::path& file : files) loads.push_back(leg_load(load_load(file)));
  with_all_loads(robot, loads);
  return loads;
}

Pick stated_pick(const PickSetup& setup, const Eigen::Isometry3d& map_from_place, const Robot& robot) {
  Pick pick;
  pick.object = {
      setup.name, setup.link,   Eigen::Isometry3d::Identity(), load_shape(setup.shape, "pick " + setup.name),
      setup.mass, setup.touches};
  pick.map_from_object = setup.map_from_object;
  pick.object_from_tip = setup.object_from_tip;
  pick.approach = setup.approach;
  pick.lift = setup.lift;
  pick.contact = setup.contact;
  pick.margin = setup.margin;
  pick.depth = setup.depth;
  for (const auto& [joint, values] : setup.grip) pick.grip[joint] = {values.first, values.second};
  pick.map_from_place = map_from_place;
  with_load(robot, pick.object);
  return pick;
}

Pick choose_pick(const std::filesystem::path& file, const std::string& place, const Robot& robot) {
  const PickSetup setup = load_pick(file);
  if (place.empty() && !setup.map_from_place)
    throw std::invalid_argument("--place: expected where " + quote(setup.name) +
                                " goes, here or as 'place' in " + quote_path(file.string()));
  if (place.empty()) return stated_pick(setup, *setup.map_from_place, robot);
  const std::vector<double> numbers = parse_numbers(place, "--place");
  Eigen::Isometry3d map_from_place = pose_from_numbers(numbers, "--place");
  if (numbers.size() == 3) map_from_place.linear() = setup.map_from_object.linear();
  return stated_pick(setup, map_from_place, robot);
}

Robot with_all_loads(const Robot& robot, const std::vector<LegLoad>& loads) {
  Robot loaded = robot;
  for (const LegLoad& load : loads) loaded = with_load(loaded, load.load);
  return loaded;
}

std::pair<Policies, std::map<std::string, Policy>> parted_policies(Policies policies,
                                                                   const std::vector<LegLoad>& loads) {
  std::map<std::string, Policy> of_loads;
  for (const LegLoad& load : loads) {
    const auto found = policies.parts.find(load.load.name);
    if (found == policies.parts.end()) continue;
    of_loads.insert(*found);
    policies.parts.erase(found);
  }
  return {std::move(policies), std::move(of_loads)};
}

std::map<std::string, Policy> loaded_policies(const ConfigurationSpace& space,
                                              const std::vector<LegLoad>& loads,
                                              const std::map<std::string, Policy>& of_loads) {
  Policies policies{.parts = space.policies(), .other = Policy::not_occupied};
  policies.parts.insert(of_loads.begin(), of_loads.end());
  return part_policies(with_all_loads(space.robot(), loads), space.map(), policies);
}

std::vector<std::string> hold_notes(const Robot& robot, const std::vector<LegLoad>& loads) {
  constexpr double near_within = 0.02;  // m
  const Configuration q = resting_configuration(robot);
  std::vector<std::string> notes;
  for (const LegLoad& load : loads) {
    const Robot loaded = with_load(robot, load.load);
    const LinkPoses poses = forward_kinematics(loaded, q);
    const int last = static_cast<int>(loaded.bodies.size()) - 1;
    double nearest = HUGE_VAL;
    for (const std::string& holder : holders_of(loaded, load.load.name))
      for (int i = 0; i < last; ++i)
        if (loaded.bodies[static_cast<std::size_t>(i)].part == holder)
          nearest = std::min(nearest, pair_distance(loaded, {i, last, {}}, poses).lower);
    if (nearest > near_within && std::isfinite(nearest))
      notes.push_back("load " + quote(load.load.name) + " is " + significant(1e3 * nearest, 3) +
                      " mm from link " + quote(load.load.link) + " and what it touches: what holds it?");
  }
  return notes;
}

std::string describe_load(const LegLoad& load) {
  std::string text = shortened(load.load.name) + " on " + shortened(load.load.link);
  for (std::size_t i = 0; i < load.legs.size(); ++i)
    text +=
        (i == 0 ? (load.legs.size() == 1 ? ", leg " : ", legs ") : ", ") + std::to_string(load.legs[i] + 1);
  return text;
}

}  // namespace clearway
