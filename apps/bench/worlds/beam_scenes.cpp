#include "apps/bench/worlds/beam_scenes.hpp"

#include <numbers>

#include "apps/bench/worlds/arm_worlds.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway::bench {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// A room about the arm, scanned, and spheres of `radius` painted where `centers` says.
Snapshot scanned_room(double resolution, const Robot& robot, const std::vector<Sphere>& painted) {
  const ArmWorld room{.resolution = resolution, .half = 1.4, .spheres = 0, .gap = 2.0 * resolution};
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  for (const Scan& scan : room.scans()) map.insert(scan);
  const int volume = map.add_volume("free", robot.critical_parts);
  for (const Sphere& sphere : painted) map.paint(volume, sphere);
  return map.snapshot();
}

/// 600 spheres painted about the way of the tip, none of which meets a pocket of radius `hole` in its middle.
void paint_way(BeamScene& scene, double resolution, double hole) {
  const auto tip = [&](double t) {
    return tip_pose(scene.robot, scene.start + t * (scene.goal - scene.start)).translation().eval();
  };
  const Sphere pocket{tip(0.5), hole};
  Dice dice(1);
  std::vector<Sphere> painted;
  while (painted.size() < 600) {
    const Eigen::Vector3d aside(dice.between(-0.25, 0.25), dice.between(-0.25, 0.25),
                                dice.between(-0.25, 0.25));
    const Sphere sphere{tip(dice.between(-0.1, 1.1)) + aside, dice.between(0.15, 0.25)};
    if (hole > 0.0 && (sphere.center - pocket.center).norm() < sphere.radius + pocket.radius) continue;
    painted.push_back(sphere);
  }
  scene.map = scanned_room(resolution, scene.robot, painted);
}

BeamScene puma_scene(const std::string& name, double resolution, double hole) {
  BeamScene scene{name, load_robot("puma560"), {}, Configuration(6), {}};
  scene.start << 0.0, -0.8, 0.3, 0.0, 0.4, 0.0;
  scene.goal = scene.start;
  scene.goal[0] += 43.0 * degree, scene.goal[1] += 20.0 * degree, scene.goal[4] -= 11.3 * degree;
  paint_way(scene, resolution, hole);
  return scene;
}

/// The robot on three sliding joints, x, y and z, that carry its root.
Robot on_gantry(const Robot& robot, double travel) {
  Robot gantry = robot;
  gantry.name += "_gantry";
  gantry.joints.clear();
  gantry.links.assign(1, Link{});
  gantry.links[0].name = "gantry";
  for (int axis = 0; axis < 3; ++axis) {
    Joint joint;
    joint.name = std::string("slide_") + "xyz"[axis];
    joint.kind = JointKind::prismatic;
    joint.axis = Eigen::Vector3d::Unit(axis);
    joint.lower = -travel, joint.upper = travel;
    joint.friction = 0.1;
    joint.step = 0.005;
    gantry.joints.push_back(joint);
    Link carriage;
    carriage.name = "carriage_" + joint.name;
    carriage.parent = axis;
    carriage.joint = axis;
    carriage.mass = 5.0;
    gantry.links.push_back(carriage);
  }
  const int links = static_cast<int>(gantry.links.size());
  for (Link link : robot.links) {
    link.parent = link.parent < 0 ? links - 1 : link.parent + links;
    if (link.joint >= 0) link.joint += 3;
    gantry.links.push_back(link);
  }
  gantry.joints.insert(gantry.joints.end(), robot.joints.begin(), robot.joints.end());
  for (Body& body : gantry.bodies) body.link += links;
  gantry.tip_link += links;
  return gantry;
}

}  // namespace

BeamScene compact_scene(double resolution) { return puma_scene("compact", resolution, 0.0); }
BeamScene holed_scene(double resolution) { return puma_scene("holed", resolution, 0.08); }

BeamScene seven_joint_scene(double resolution) {
  BeamScene scene{"panda", load_robot("panda"), {}, Configuration(7), {}};
  scene.start << 0.0, -0.6, 0.0, -2.0, 0.0, 1.6, 0.8;
  scene.goal = scene.start;
  scene.goal[0] += 43.0 * degree, scene.goal[1] += 20.0 * degree, scene.goal[5] -= 11.3 * degree;
  paint_way(scene, resolution, 0.0);
  return scene;
}

BeamScene ten_joint_scene(double resolution) {
  BeamScene scene{"panda on a gantry", on_gantry(load_robot("panda"), 0.5), {}, Configuration(10), {}};
  scene.start << -0.1, 0.1, 0.2, 0.0, -0.6, 0.0, -2.0, 0.0, 1.6, 0.8;
  scene.goal = scene.start;
  scene.goal[0] += 0.2, scene.goal[1] -= 0.15, scene.goal[2] += 0.1;
  scene.goal[3] += 43.0 * degree, scene.goal[4] += 20.0 * degree, scene.goal[8] -= 11.3 * degree;
  paint_way(scene, resolution, 0.0);
  return scene;
}

}  // namespace clearway::bench
