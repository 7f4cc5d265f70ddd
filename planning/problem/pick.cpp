#include "planning/problem/pick.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/rigid_pose.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {
namespace {

constexpr double same_pick = 1e-6;  ///< m
constexpr double longest = 10.0;    ///< m, of approach and lift
constexpr double most_voxels = 1e7;

bool is_pose(const Eigen::Isometry3d& pose) {
  return pose.matrix().allFinite() && is_rotation(pose.linear());
}

/// The joint's place among the robot's; none: it has no such joint.
std::optional<std::size_t> joint_of(const Robot& robot, const std::string& name) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].name == name) return i;
  return std::nullopt;
}

bool are_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() <= same_pick;
}

}  // namespace

std::vector<std::string> names_of_legs(bool has_goal) {
  std::vector<std::string> names = {"approach", "reach", "lift", "carry", "lower", "retreat"};
  if (has_goal) names.emplace_back("leave");
  return names;
}

Eigen::VectorXd with_grip(const Robot& robot, const Pick& pick, Eigen::VectorXd q, bool is_closed) {
  for (const auto& [name, grip] : pick.grip)
    if (const auto joint = joint_of(robot, name))
      q[static_cast<Eigen::Index>(*joint)] = is_closed ? grip.closed : grip.open;
  return q;
}

void require_grip(const Robot& robot, const Pick& pick) {
  const auto refuse = [&](const std::string& name, const std::string& what) {
    throw std::invalid_argument("pick " + quote(pick.object.name) + ", grip, joint " + quote(name) + ": " +
                                what);
  };
  for (const auto& [called, grip] : pick.grip) {
    const std::string& name = called;  // clang 14 takes no part of a pair into a lambda
    const auto joint = joint_of(robot, name);
    const bool is_held = std::any_of(robot.held.begin(), robot.held.end(),
                                     [&](const HeldJoint& held) { return held.name == name; });
    if (is_held) refuse(name, "it is held still, expected a planning group (--group) with arm and hand");
    if (!joint) refuse(name, "expected a joint that robot " + quote(robot.name) + " plans for");
    if (moves_tip(robot, *joint))
      refuse(name, "expected a joint of the hand, this one moves the tip, link " +
                       quote(robot.links[static_cast<std::size_t>(robot.tip_link)].name) +
                       " (--tip chooses another)");
    for (const double value : {grip.open, grip.closed})
      if (!(value >= robot.joints[*joint].lower && value <= robot.joints[*joint].upper))
        refuse(name, "expected values within its limits, " + short_text(robot.joints[*joint].lower) + " to " +
                         short_text(robot.joints[*joint].upper) + ", got " + short_text(value));
  }
}

std::vector<std::vector<Eigen::VectorXd>> stretches_of(const Robot& robot, const Pick& pick,
                                                       const std::vector<Eigen::VectorXd>& path) {
  std::vector<std::vector<Eigen::VectorXd>> stretches(1);
  const auto moves = [&](std::size_t edge) {
    for (const auto& [name, grip] : pick.grip)
      if (const auto joint = joint_of(robot, name)) {
        const auto at = static_cast<Eigen::Index>(*joint);
        if (path[edge][at] != path[edge + 1][at]) return true;
      }
    return false;
  };
  for (std::size_t i = 0; i < path.size(); ++i) {
    stretches.back().push_back(path[i]);
    if (i > 0 && i + 1 < path.size() && moves(i - 1) != moves(i)) stretches.push_back({path[i]});
  }
  return stretches;
}

std::optional<Shape> core_of(const Pick& pick) {
  if (pick.grip.empty()) return std::nullopt;
  return pick.object.shape.core(pick.depth);
}

std::string core_name(const Pick& pick) {
  double deepest = pick.depth;  // less in slim objects
  if (const auto core = core_of(pick))
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
      deepest = std::min(deepest, unit.dot(pick.object.shape.support(unit)) - unit.dot(core->support(unit)));
    }
  return pick.object.name + "-deeper-than-" + short_text(1e3 * deepest, 3) + "mm";
}

std::vector<int> legs_that_carry() { return {2, 3, 4}; }

double contact_length(const Pick& pick, double resolution, double padding) {
  return pick.contact == 0.0 ? 2.0 * (resolution + padding) : pick.contact;
}

double layer_reach(double resolution, double padding) { return 1.05 * resolution + padding; }

void require_sound(const Pick& pick, double resolution, double padding) {
  const auto require = [&](bool holds, const std::string& field, const std::string& expected) {
    if (!holds)
      throw std::invalid_argument("pick " + quote(pick.object.name) + ", " + field + ": expected " +
                                  expected);
  };
  require(is_pose(pick.map_from_object), "pose", "finite numbers and a rotation");
  require(is_pose(pick.map_from_place), "place", "finite numbers and a rotation");
  require(is_pose(pick.object_from_tip), "grasp", "finite numbers and a rotation");
  require(pick.approach.norm() > 0.0 && pick.approach.norm() <= longest, "approach",
          "a way of more than 0 and at most 10 m");
  require(pick.margin >= 0.0 && pick.margin <= 0.1, "margin", "a length from 0 to 0.1 m");
  require(pick.depth >= 0.0 && pick.depth <= 1.0, "depth", "a length from 0 to 1 m");
  for (const Eigen::Isometry3d& pose : {pick.map_from_object, pick.map_from_place}) {
    const Eigen::Array3d sizes =
        pick.object.shape.bounds(pose).sizes().array() + 2.0 * (pick.margin + padding);
    require((sizes / resolution + 3.0).prod() <= most_voxels, "shape", "at most 10 million voxels round it");
  }
  const double contact = contact_length(pick, resolution, padding), least = resolution + padding;
  require(contact > least && contact <= 0.1 + 2.0 * least, "contact",
          "more than a voxel and the padding, " + short_text(least) +
              " m, and at most 0.1 m more than twice that");
  require(pick.lift >= contact && pick.lift <= longest, "lift",
          "a length from the contact, " + short_text(contact) + " m, to 10 m");
}

bool is_same(const Pick& a, const Pick& b) {
  Load first = a.object, second = b.object;
  first.link_from_load = second.link_from_load;
  const auto near = [](double x, double y) { return std::abs(x - y) <= same_pick; };
  return is_same(first, second) && are_near(a.map_from_object, b.map_from_object) &&
         are_near(a.map_from_place, b.map_from_place) && are_near(a.object_from_tip, b.object_from_tip) &&
         (a.approach - b.approach).norm() <= same_pick && near(a.lift, b.lift) &&
         near(a.contact, b.contact) && near(a.margin, b.margin) &&
         std::equal(a.grip.begin(), a.grip.end(), b.grip.begin(), b.grip.end(),
                    [&](const auto& one, const auto& other) {
                      return one.first == other.first && near(one.second.open, other.second.open) &&
                             near(one.second.closed, other.second.closed);
                    });
}

}  // namespace clearway
