#include "planning/robot_files/allowed_collisions.hpp"

#include <algorithm>
#include <numbers>
#include <random>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {
namespace {

constexpr int sampled_configurations = 200;
constexpr double always_ratio = 0.95;

/// For each link the topmost link that it is rigidly fixed to.
std::vector<int> rigid_groups(const Robot& robot) {
  std::vector<int> group(robot.links.size());
  for (std::size_t i = 0; i < group.size(); ++i) {
    const Link& link = robot.links[i];
    group[i] = link.joint < 0 && link.parent >= 0 ? group[static_cast<std::size_t>(link.parent)]
                                                  : static_cast<int>(i);
  }
  return group;
}

/// For each link the one across the joint above it, -1 without one. Links without bodies that are fixed on
/// either side of the joint are passed over.
std::vector<int> link_across(const Robot& robot) {
  std::vector<bool> has_body(robot.links.size(), false);
  for (const Body& body : robot.bodies) has_body[static_cast<std::size_t>(body.link)] = true;
  const auto parent_of = [&](int link) { return robot.links[static_cast<std::size_t>(link)].parent; };
  const auto is_moved = [&](int link) { return robot.links[static_cast<std::size_t>(link)].joint >= 0; };
  std::vector<int> across(robot.links.size(), -1);
  for (int i = 0; i < static_cast<int>(across.size()); ++i) {
    int lower = i;
    while (!is_moved(lower) && parent_of(lower) >= 0 && !has_body[static_cast<std::size_t>(parent_of(lower))])
      lower = parent_of(lower);
    if (!is_moved(lower)) continue;
    int upper = parent_of(lower);
    while (!has_body[static_cast<std::size_t>(upper)] && !is_moved(upper) && parent_of(upper) >= 0)
      upper = parent_of(upper);
    across[static_cast<std::size_t>(i)] = upper;
  }
  return across;
}

/// Zero, clamped into the limits.
Configuration at_zero(const Robot& robot) {
  Configuration q(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j)
    q[static_cast<Eigen::Index>(j)] = std::clamp(0.0, robot.joints[j].lower, robot.joints[j].upper);
  return q;
}

/// A value within the limits; an unlimited joint turns freely, so one turn stands for all: of the slowest
/// link that follows it.
double random_value(const Robot& robot, std::size_t j, std::mt19937_64& random) {
  const Joint& joint = robot.joints[j];
  double turn = std::numbers::pi;
  for (const Link& link : robot.links)
    if (link.joint == static_cast<int>(j) && kind_of(robot, link) == JointKind::revolute)
      turn = std::max(turn, std::numbers::pi / std::abs(link.multiplier));
  const double lower = std::isfinite(joint.lower) ? joint.lower : -turn;
  const double upper = std::isfinite(joint.upper) ? joint.upper : turn;
  const double unit = random_unit(random);
  return lower + unit * (upper - lower);
}

bool touch(const Robot& robot, const LinkPoses& poses, std::pair<int, int> pair) {
  const Body& a = robot.bodies[static_cast<std::size_t>(pair.first)];
  const Body& b = robot.bodies[static_cast<std::size_t>(pair.second)];
  const Eigen::Isometry3d pose_a = poses[static_cast<std::size_t>(a.link)] * a.link_from_shape;
  const Eigen::Isometry3d pose_b = poses[static_cast<std::size_t>(b.link)] * b.link_from_shape;
  return distance(a.shape, pose_a, b.shape, pose_b, 0.0).lower <= 0.0;
}

/// Two bodies on either side of one joint: `below` moves with it.
struct AcrossJoint {
  int above, below;
  int mover;  ///< the link that the joint moves
};

/// Whether the bodies stay apart wherever the joint between them stands, proved: halves of its range are
/// looked at until the distance in the middle of each is more than anything moves on the way to its ends.
bool never_meet(const Robot& robot, const AcrossJoint& pair) {
  constexpr double margin = 1e-6;  ///< m, for rounding
  constexpr int most_looks = 200;
  const Link& link = robot.links[static_cast<std::size_t>(pair.mover)];
  const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
  const bool is_limited = std::isfinite(joint.lower) && std::isfinite(joint.upper);
  const bool turns = kind_of(robot, link) == JointKind::revolute;
  if (!turns && !is_limited) return false;
  const double turn = std::numbers::pi / std::abs(link.multiplier);  // half a turn of the link itself
  const double lower = is_limited ? joint.lower : -turn, upper = is_limited ? joint.upper : turn;
  Configuration q = at_zero(robot);
  const auto poses_at = [&](double value) {
    q[link.joint] = value;
    return forward_kinematics(robot, q);
  };
  const Body& a = robot.bodies[static_cast<std::size_t>(pair.above)];
  const Body& b = robot.bodies[static_cast<std::size_t>(pair.below)];
  const auto place = [](const LinkPoses& poses, const Body& body) {
    return poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
  };
  const LinkPoses first = poses_at(lower);
  const Eigen::Vector3d center =
      first[static_cast<std::size_t>(pair.mover)].inverse() * place(first, b).translation();
  const double lever = center.cross(axis_of(robot, link)).norm() + b.shape.bounding_radius();
  const double speed = std::abs(link.multiplier) * (turns ? lever : 1.0);
  std::vector<std::pair<double, double>> open{{lower, upper}};
  for (int looks = 0; !open.empty(); ++looks) {
    if (looks == most_looks) return false;
    const auto [from, to] = open.back();
    open.pop_back();
    const double half = (to - from) / 2.0, middle = from + half, way = speed * half + margin;
    const LinkPoses poses = poses_at(middle);
    const double apart = distance(a.shape, place(poses, a), b.shape, place(poses, b), way).lower;
    if (apart >= way) continue;
    if (apart <= 0.0) return false;
    open.emplace_back(from, middle);
    open.emplace_back(middle, to);
  }
  return true;
}

}  // namespace

std::vector<std::pair<int, int>> adjacent_bodies(const Robot& robot) {
  const std::vector<int> group = rigid_groups(robot), across = link_across(robot);
  const auto link_of = [&](int body) {
    return static_cast<std::size_t>(robot.bodies[static_cast<std::size_t>(body)].link);
  };
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b) {
      const std::size_t i = link_of(a), k = link_of(b);
      const bool share_joint = across[i] == static_cast<int>(k) || across[k] == static_cast<int>(i);
      if (group[i] == group[k] || share_joint) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

std::vector<std::pair<int, int>> never_meeting_bodies(const Robot& robot) {
  const std::vector<int> group = rigid_groups(robot);
  const auto group_of = [&](int body) {
    return group[static_cast<std::size_t>(robot.bodies[static_cast<std::size_t>(body)].link)];
  };
  const auto above = [&](int g) {
    const Link& link = robot.links[static_cast<std::size_t>(g)];
    return link.joint < 0 || link.parent < 0 ? -1 : group[static_cast<std::size_t>(link.parent)];
  };
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b) {
      const int upper = group_of(a), lower = group_of(b);
      const bool is_below = above(lower) == upper;
      if (!is_below && above(upper) != lower) continue;
      const AcrossJoint pair = is_below ? AcrossJoint{a, b, lower} : AcrossJoint{b, a, upper};
      if (never_meet(robot, pair)) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

std::vector<std::pair<int, int>> always_colliding_bodies(const Robot& robot) {
  std::vector<LinkPoses> samples;
  Configuration q = at_zero(robot);
  samples.push_back(forward_kinematics(robot, q));
  std::mt19937_64 random(1);
  for (int i = 0; i < sampled_configurations; ++i) {
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      q[static_cast<Eigen::Index>(j)] = random_value(robot, j, random);
    }
    samples.push_back(forward_kinematics(robot, q));
  }
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b) {
      if (!touch(robot, samples.front(), {a, b})) continue;
      const auto count = std::count_if(samples.begin() + 1, samples.end(), [&](const LinkPoses& poses) {
        return touch(robot, poses, {a, b});
      });
      if (static_cast<double>(count) >= always_ratio * sampled_configurations) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

std::vector<std::pair<int, int>> bodies_of_parts(
    const Robot& robot, const std::vector<std::pair<std::string, std::string>>& parts,
    const std::filesystem::path& file) {
  const auto bodies_of = [&](const std::string& part) {
    std::vector<int> bodies;
    int index = 0;
    for (const Body& body : robot.bodies) {
      if (body.part == part) bodies.push_back(index);
      ++index;
    }
    const bool link =
        std::any_of(robot.links.begin(), robot.links.end(), [&](const Link& l) { return l.name == part; });
    if (bodies.empty() && !link) {
      throw std::invalid_argument(file.string() + ": an exempt pair names " + quote(part) + ", which " +
                                  robot.name + " does not have");
    }
    return bodies;
  };
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [first, second] : parts) {
    const std::vector<int> others = bodies_of(second);
    for (int a : bodies_of(first)) {
      for (int b : others) {
        if (a != b) pairs.emplace_back(std::min(a, b), std::max(a, b));
      }
    }
  }
  return pairs;
}

}  // namespace clearway
