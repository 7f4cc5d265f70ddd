#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "planning/check/check_pick.hpp"
#include "planning/geometry/shape.hpp"
#include "planning/path/smooth_motion.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace can_errand {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;

constexpr double edge = 0.02, top = 0.1;

/// A gantry whose hand takes a can from the side, with a ball on a rod that is not drawn: on the can's axis,
/// `below` its middle. @param more links and joints
inline worlds::UrdfRobot gantry(double below, const std::string& more) {
  const std::string none = "<link name='base'/><link name='x'/><link name='y'/>";
  return {"gantry",
          none + urdf_link("hand", "-0.03 0 0", "<sphere radius='0.005'/>") +
              urdf_link("fork", "0 0 0", "<sphere radius='0.005'/>") +
              urdf_joint("jx", "prismatic", "base", "x", "0 0 0", "1 0 0", urdf_limit(-1, 1)) +
              urdf_joint("jy", "prismatic", "x", "y", "0 0 0", "0 1 0", urdf_limit(-1, 1)) +
              urdf_joint("jz", "prismatic", "y", "hand", "0 0 0", "0 0 1", urdf_limit(-1, 1)) +
              urdf_joint("rod", "fixed", "hand", "fork", "0 0 " + std::to_string(-below), "1 0 0", "") +
              more};
}

/// A can on a shelf that is one voxel thick is taken, carried along it and put down; as its legs go by hand.
struct Errand {
  explicit Errand(double below, double lift = 0.1, const std::string& more = "")
      : below_(below), gantry_(gantry(below, more)), robot(gantry_.robot()) {
    for (std::size_t i = 0; i < robot.links.size(); ++i)
      if (robot.links[i].name == "hand") robot.tip_link = static_cast<int>(i);
    pick.object.name = "can";
    pick.object.link = "hand";
    pick.object.shape = Shape::cylinder(0.03, 0.12);
    pick.map_from_object.translation() << 0.2, 0.1, middle;
    pick.map_from_place.translation() << 0.2, -0.1, middle;
    pick.approach << 0.1, 0.0, 0.0;
    pick.lift = lift;
    pick.margin = 0.02;
    legs = {{at(0.05, 0.1, 0), at(0.1, 0.1, 0)}, {at(0.1, 0.1, 0), at(0.2, 0.1, 0)}, {}, {}, {}, {}};
    const int steps = static_cast<int>(std::lround(lift / 0.005));
    for (int i = 0; i <= steps; ++i) legs[2].push_back(at(0.2, 0.1, 0.005 * i));
    legs[3] = {legs[2].back(), at(0.2, -0.1, 0.005 * steps)};
    for (int i = steps; i >= 0; --i) legs[4].push_back(at(0.2, -0.1, 0.005 * i));
    legs[5] = {at(0.2, -0.1, 0), at(0.1, -0.1, 0)};
  }

  static Configuration at(double x, double y, double up) { return Eigen::Vector3d(x, y, middle + up); }

  PickToCheck stated(const Snapshot& map) const {
    return {robot, map, pick, Eigen::Isometry3d::Identity(), legs};
  }

  /// From a voxel to the hand, the fork and, on its way, the can where a verdict says that they meet it.
  double distance_at(const PathVerdict& verdict, const Eigen::Vector3d& voxel) const {
    std::vector<Configuration> all{legs[0][0]};
    std::vector<bool> is_carried;  // on each edge
    for (std::size_t leg = 0; leg < legs.size(); ++leg) {
      all.insert(all.end(), legs[leg].begin() + 1, legs[leg].end());
      is_carried.resize(all.size() - 1, leg >= 2 && leg <= 4);
    }
    const auto i = static_cast<std::size_t>(verdict.edge);
    if (verdict.edge < 0 || i + 1 >= all.size()) return HUGE_VAL;
    const Eigen::Vector3d hand = all[i] + verdict.parameter * (all[i + 1] - all[i]);
    const auto distance_of = [&](const Shape& shape, const Eigen::Vector3d& at) {
      return distance_to_cube(shape, Eigen::Isometry3d(Eigen::Translation3d(at)), voxel, edge).upper;
    };
    const Shape ball = Shape::sphere(0.005);
    return std::min({distance_of(ball, hand + Eigen::Vector3d(-0.03, 0.0, 0.0)),
                     distance_of(ball, hand + Eigen::Vector3d(0.0, 0.0, -below_)),
                     is_carried[i] ? distance_of(pick.object.shape, hand) : HUGE_VAL});
  }

  PathVerdict path(const Snapshot& map) const { return check_pick(stated(map), {}, 0.0); }

  SmoothMotion smooth() const {
    return smooth_motion(ConfigurationSpace(robot, Snapshot(), {.parts = {}, .critical_by_default = false}),
                         legs);
  }
  MotionVerdict motion(const Snapshot& map) const { return motion(map, smooth()); }
  /// @param left_out legs at the end of the motion that it lacks @param share of the speeds that may be
  MotionVerdict motion(const Snapshot& map, const SmoothMotion& made, std::size_t left_out = 0,
                       double share = 1.0) const {
    std::vector<std::size_t> ends = made.leg_ends;
    ends.resize(ends.size() - left_out);
    MotionToCheck motion{made.motion, ends, {legs.front().front()}, rate_limits(robot)};
    motion.limits.velocity *= share;
    for (const auto& leg : legs) motion.stops.push_back(leg.back());
    return check_pick_motion(stated(map), motion, {}, 0.0);
  }

  static constexpr double middle = top + 0.06;
  double below_;
  worlds::UrdfRobot gantry_;
  Robot robot;
  Pick pick;
  std::vector<std::vector<Configuration>> legs;
};

inline Snapshot shelf() {
  return VoxelScene{edge,
                    {box_of(0.1, -0.2, top - edge, 0.3, 0.2, top - 0.001),   // shelf
                     box_of(0.175, 0.075, top, 0.225, 0.125, top + 0.119)},  // can
                    {},
                    {}}
      .snapshot();
}

}  // namespace can_errand
}  // namespace clearway
