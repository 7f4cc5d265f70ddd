#include "planning/robot/reach.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace clearway {
namespace {

const Link& link_at(const Robot& robot, int index) { return robot.links[static_cast<std::size_t>(index)]; }
bool turns(const Robot& robot, const Link& link) {
  return link.joint >= 0 && kind_of(robot, link) == JointKind::revolute;
}

bool slides(const Robot& robot, const Link& link) {
  return link.joint >= 0 && kind_of(robot, link) == JointKind::prismatic;
}

/// m: no map reaches so far from the origin.
constexpr double beyond_maps = 1e8;

/// The two ends of a sliding joint's travel, as it moves this link.
std::pair<double, double> travel(const Robot& robot, const Link& link) {
  const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
  return std::minmax(link.multiplier * joint.lower + link.offset,
                     link.multiplier * joint.upper + link.offset);
}

/// Links from the root to `link`.
std::vector<int> chain_to(const Robot& robot, int link) {
  std::vector<int> chain;
  for (int i = link; i >= 0; i = link_at(robot, i).parent) chain.push_back(i);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

/// What is known of a frame's place in every configuration: a box of its origin, and its rotation, which is
/// `rotation` exactly, or that after any turn about `axis` (map frame), or anything.
struct PlaceOfPoint {
  enum class Turned { not_at_all, about_axis, anyhow };
  Eigen::AlignedBox3d box;
  Eigen::Matrix3d rotation;
  Turned turned = Turned::not_at_all;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();

  void grow(const Eigen::Vector3d& half) {
    box.min() -= half;
    box.max() += half;
  }

  /// Moves the origin by a vector of its own frame.
  void shift(const Eigen::Vector3d& own) {
    const Eigen::Vector3d v = rotation * own;
    if (turned == Turned::not_at_all) {
      box.translate(v);
    } else if (turned == Turned::anyhow) {
      grow(Eigen::Vector3d::Constant(v.norm()));
    } else {
      const double along = v.dot(axis);
      const double around = (v - along * axis).norm();
      box.translate(Eigen::Vector3d(along * axis));
      // A circle of radius r about the axis spans r sqrt(1 - axis_i^2) along map axis i.
      grow(around * (1.0 - axis.array().square()).max(0.0).sqrt().matrix());
    }
  }

  void turn_about(const Eigen::Vector3d& own_axis) {
    const Eigen::Vector3d direction = rotation * own_axis;
    const bool same = turned == Turned::not_at_all ||
                      (turned == Turned::about_axis && direction.cross(axis).norm() < 1e-12);
    turned = same ? Turned::about_axis : Turned::anyhow;
    axis = direction;
  }
};

}  // namespace

Eigen::AlignedBox3d reach_box(const Robot& robot, const Body& body) {
  PlaceOfPoint place;
  place.box = Eigen::AlignedBox3d(robot.map_from_base.translation());
  place.rotation = robot.map_from_base.linear();
  for (int index : chain_to(robot, body.link)) {
    const Link& link = link_at(robot, index);
    place.shift(link.parent_from_link.translation());
    place.rotation = place.rotation * link.parent_from_link.linear();
    if (slides(robot, link)) {
      const auto [low, high] = travel(robot, link);
      const Eigen::Vector3d axis = axis_of(robot, link);
      PlaceOfPoint other = place;
      place.shift(std::max(low, -beyond_maps) * axis);  // without limits: infinite
      other.shift(std::min(high, beyond_maps) * axis);
      place.box.extend(other.box);
    }
    if (turns(robot, link)) place.turn_about(axis_of(robot, link));
  }
  if (place.turned == PlaceOfPoint::Turned::not_at_all) {
    const Eigen::Isometry3d rotation(place.rotation);
    const Eigen::AlignedBox3d own = body.shape.bounds(rotation * body.link_from_shape);
    return {place.box.min() + own.min(), place.box.max() + own.max()};
  }
  Eigen::AlignedBox3d whole;
  for (const Sphere& sphere : body.cover) {
    PlaceOfPoint at = place;
    at.shift(sphere.center);
    at.grow(Eigen::Vector3d::Constant(sphere.radius));
    whole.extend(at.box);
  }
  return whole;
}

double lever(const Robot& robot, int link, const Body& body) {
  const Link& mover = link_at(robot, link);
  if (!turns(robot, mover)) return 1.0;
  const Eigen::Vector3d axis = axis_of(robot, mover);
  const auto off_axis = [&](const Eigen::Vector3d& v) { return (v - v.dot(axis) * axis).norm(); };
  if (body.link == link) {
    double farthest = 0.0;
    for (const Sphere& sphere : body.cover)
      farthest = std::max(farthest, off_axis(sphere.center) + sphere.radius);
    return std::min(farthest, off_axis(body.link_from_shape.translation()) + body.shape.bounding_radius());
  }
  double radius = body.link_from_shape.translation().norm() + body.shape.bounding_radius();
  for (int i = body.link; i != link; i = link_at(robot, i).parent) {
    const Link& at = link_at(robot, i);
    const Eigen::Vector3d offset = at.parent_from_link.translation();
    radius += at.parent == link ? off_axis(offset) : offset.norm();
    if (slides(robot, at)) {
      const auto [low, high] = travel(robot, at);
      radius += std::max(std::abs(low), std::abs(high));
    }
  }
  return radius;
}

double reach_below(const Robot& robot, int link) {
  double farthest = 0.0;
  for (const Body& body : robot.bodies) {
    double radius = body.link_from_shape.translation().norm() + body.shape.bounding_radius();
    int i = body.link;
    for (; i >= 0 && i != link; i = link_at(robot, i).parent) {
      const Link& at = link_at(robot, i);
      radius += at.parent_from_link.translation().norm();
      if (!slides(robot, at)) continue;
      const auto [low, high] = travel(robot, at);
      radius += std::max(std::abs(low), std::abs(high));
    }
    if (i == link) farthest = std::max(farthest, radius);
  }
  return farthest;
}

Eigen::VectorXd body_levers(const Robot& robot, const Body& body) {
  Eigen::VectorXd levers = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (int i = body.link; i >= 0; i = link_at(robot, i).parent) {
    const Link& link = link_at(robot, i);
    if (link.joint >= 0) levers[link.joint] += std::abs(link.multiplier) * lever(robot, i, body);
  }
  return levers;
}

double tip_reach(const Robot& robot) {
  double reach = robot.link_from_tip.translation().norm();
  for (const int index : chain_to(robot, robot.tip_link)) {
    const Link& link = link_at(robot, index);
    reach += link.parent_from_link.translation().norm();
    if (slides(robot, link)) {
      const auto [low, high] = travel(robot, link);
      reach += std::max(std::abs(low), std::abs(high)) * axis_of(robot, link).norm();
    }
  }
  return (1.0 + 1e-9) * reach;
}

bool is_moved(const Robot& robot, int link) {
  for (int i = link; i >= 0; i = link_at(robot, i).parent) {
    if (link_at(robot, i).joint >= 0) return true;
  }
  return false;
}

bool is_policed(const Robot& robot, int link) {
  const auto& standing = robot.standing;
  const bool stands =
      std::find(standing.begin(), standing.end(), link_at(robot, link).name) != standing.end();
  if (stands && !is_moved(robot, link)) return false;
  for (int i = link; i >= 0; i = link_at(robot, i).parent) {
    if (link_at(robot, i).joint >= 0 || link_at(robot, i).is_held) return true;
  }
  return false;
}

}  // namespace clearway
