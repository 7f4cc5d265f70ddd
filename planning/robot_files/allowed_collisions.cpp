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

/// A value within the limits; an unlimited joint turns freely, so one turn stands for all.
double random_value(const Joint& joint, std::mt19937_64& random) {
  const double lower = std::isfinite(joint.lower) ? joint.lower : -std::numbers::pi;
  const double upper = std::isfinite(joint.upper) ? joint.upper : std::numbers::pi;
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

std::vector<std::pair<int, int>> always_colliding_bodies(const Robot& robot) {
  std::vector<LinkPoses> samples;
  Configuration q(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    q[static_cast<Eigen::Index>(j)] = std::clamp(0.0, robot.joints[j].lower, robot.joints[j].upper);
  }
  samples.push_back(forward_kinematics(robot, q));
  std::mt19937_64 random(1);
  for (int i = 0; i < sampled_configurations; ++i) {
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      q[static_cast<Eigen::Index>(j)] = random_value(robot.joints[j], random);
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
