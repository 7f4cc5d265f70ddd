#include "apps/compare/planner_world.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mapping/system/input_file.hpp"
#include "mapping/voxels/voxel_state.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/load_json.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// JSON knows no infinity: null.
Json limit_of(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string type_of(JointKind kind) { return kind == JointKind::revolute ? "revolute" : "prismatic"; }

Json joints_of(const Robot& robot) {
  Json joints = Json::array();
  for (const Joint& joint : robot.joints)
    joints.push_back({{"name", joint.name},
                      {"type", type_of(joint.kind)},
                      {"axis", list_of(joint.axis)},
                      {"lower", limit_of(joint.lower)},
                      {"upper", limit_of(joint.upper)},
                      {"max_velocity", joint.max_velocity}});
  return joints;
}

Json links_of(const Robot& robot) {
  Json links = Json::array();
  for (const Link& link : robot.links)
    links.push_back({{"name", link.name},
                     {"parent", link.parent},
                     {"parent_from_link", json_of(link.parent_from_link)},
                     {"joint", link.joint},
                     {"type", link.joint < 0 ? Json(nullptr) : Json(type_of(kind_of(robot, link)))},
                     {"axis", link.joint < 0 ? Json(nullptr) : list_of(axis_of(robot, link))},
                     {"multiplier", link.multiplier},
                     {"offset", link.offset}});
  return links;
}

Json bodies_of(const Robot& robot) {
  Json bodies = Json::array();
  for (const Body& body : robot.bodies) {
    Json spheres = Json::array();
    for (const Sphere& sphere : body.cover)
      spheres.push_back({sphere.center.x(), sphere.center.y(), sphere.center.z(), sphere.radius});
    bodies.push_back({{"part", body.part},
                      {"link", body.link},
                      {"shape", json_of(body.shape)},
                      {"link_from_shape", json_of(body.link_from_shape)},
                      {"spheres", std::move(spheres)}});
  }
  return bodies;
}

/// The file that a planner may read the robot from: what xacro makes stays in no file.
Json urdf_file(const Robot& robot) {
  if (robot.source.empty()) return nullptr;
  const std::filesystem::path urdf = urdf_of_robot(robot);
  return extension_of(urdf) == ".xacro" ? Json(nullptr) : Json(urdf.string());
}

Json held_of(const Robot& robot) {
  Json held = Json::object();
  for (const HeldJoint& joint : robot.held) held[joint.name] = joint.value;
  return held;
}

/// The voxels that one requirement allows, or blocks, whichever a map holds.
Json region_of(const Snapshot& map, const Requirement& requirement) {
  const bool is_unknown_free = allows(requirement, VoxelState::unknown, 0);
  Json cubes = Json::array();
  map.visit_leaves([&](const Voxel& voxel) {
    if (allows(requirement, voxel.state, voxel.volumes) != is_unknown_free)
      cubes.push_back({voxel.center.x(), voxel.center.y(), voxel.center.z(), voxel.size});
  });
  return {{"parts", Json::array()},
          {"policy", to_string(requirement.policy)},
          {is_unknown_free ? "blocked" : "free", std::move(cubes)}};
}

Json regions_of(const ConfigurationSpace& space) {
  std::vector<Requirement> known;
  Json regions = Json::array();
  for (const auto& [part, policy] : space.policies()) {
    const Requirement requirement =
        part_requirement(space.robot(), space.map(), part, policy, space.options().seen_within);
    std::size_t i = 0;
    while (i < known.size() && !(known[i] == requirement)) ++i;
    if (i == known.size()) {
      known.push_back(requirement);
      regions.push_back(region_of(space.map(), requirement));
    }
    regions[i]["parts"].push_back(part);
  }
  return regions;
}

}  // namespace

Json planner_world(const ConfigurationSpace& space) {
  const Robot& robot = space.robot();
  Json apart = Json::array();
  for (const auto& [first, second] : robot.exempt) apart.push_back({first, second});
  return {{"robot",
           {{"name", robot.name},
            {"urdf", urdf_file(robot)},
            {"srdf", robot.srdf.empty() ? Json(nullptr) : Json(robot.srdf.string())},
            {"group", robot.group},
            {"held", held_of(robot)},
            {"scale", robot.scale},
            {"map_from_base", json_of(robot.map_from_base)},
            {"joints", joints_of(robot)},
            {"links", links_of(robot)},
            {"bodies", bodies_of(robot)},
            {"may_touch", std::move(apart)},
            {"tip_link", robot.tip_link},
            {"link_from_tip", json_of(robot.link_from_tip)}}},
          {"resolution", space.map().resolution()},
          {"padding", space.options().padding},
          {"regions", regions_of(space)}};
}

}  // namespace clearway
