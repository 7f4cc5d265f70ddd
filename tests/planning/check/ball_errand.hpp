#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "planning/check/check_pick.hpp"

namespace clearway::ball_errand {

/// A hand that slides along x, y and z and turns about z.
inline Robot gantry() {
  Robot robot;
  robot.name = "gantry";
  robot.joints.resize(4);
  robot.links.resize(5);
  robot.links[0].name = "base";
  for (int i = 0; i < 4; ++i) {
    Joint& joint = robot.joints[static_cast<std::size_t>(i)];
    joint.name = "j" + std::to_string(i);
    joint.kind = i < 3 ? JointKind::prismatic : JointKind::revolute;
    joint.axis = Eigen::Vector3d::Unit(std::min(i, 2));
    joint.lower = -1.0;
    joint.upper = 1.0;
    Link& link = robot.links[static_cast<std::size_t>(i + 1)];
    link.name = i < 3 ? "slide" + std::to_string(i) : "hand";
    link.parent = link.joint = i;
  }
  robot.bodies.resize(1);
  robot.bodies[0].part = "hand";
  robot.bodies[0].link = robot.tip_link = 4;
  robot.bodies[0].shape = Shape::sphere(0.01);
  robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
  return robot;
}

inline Pick pick_of_ball(double radius) {
  Pick pick;
  pick.object.name = "ball";
  pick.object.link = "hand";
  pick.object.shape = Shape::sphere(radius);
  return pick;
}

inline Configuration at(double x, double y, double z, double turn = 0.0) {
  return Eigen::Vector4d(x, y, z, turn);
}

/// An errand of the gantry's ball, from the map's origin to a place so far aside: reach, lift, carry, lower
/// and retreat by three waypoints each.
struct BallErrand {
  BallErrand(double radius, double length, double aside) : pick(pick_of_ball(radius)) {
    pick.map_from_place.translation() << 0.0, aside, 0.0;
    pick.approach << length, 0.0, 0.0;
    pick.lift = length;
    const auto leg = [&](const Configuration& from, const Configuration& to) {
      legs.push_back({from, (from + to) / 2, to});
    };
    leg(at(-length - 0.1, 0, 0), at(-length, 0, 0));
    leg(at(-length, 0, 0), at(0, 0, 0));
    leg(at(0, 0, 0), at(0, 0, length));
    leg(at(0, 0, length), at(0, aside, length));
    leg(at(0, aside, length), at(0, aside, 0));
    leg(at(0, aside, 0), at(-length, aside, 0));
  }

  PickToCheck stated(const Snapshot& map) const {
    return {robot, map, pick, Eigen::Isometry3d::Identity(), legs};
  }

  const Robot robot = gantry();
  Pick pick;
  std::vector<std::vector<Configuration>> legs;
};

}  // namespace clearway::ball_errand
