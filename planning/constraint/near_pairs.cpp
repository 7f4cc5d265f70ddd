#include "planning/constraint/near_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "planning/geometry/segment_distance.hpp"

namespace clearway {
namespace {

Eigen::Vector3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) {
  return pose.linear().lazyProduct(point) + pose.translation();
}

/// Whether the plane of a flat end of a cylinder, with axis half + and - about `middle`, is at least `within`
/// from a body about the segment other_half + and - about `other`.
bool is_beyond_end(const Eigen::Vector3d& middle, const Eigen::Vector3d& half, const Eigen::Vector3d& other,
                   const Eigen::Vector3d& other_half, double other_radius, double within) {
  const double squared = half.squaredNorm(), along = std::abs(half.dot(other - middle));
  const double apart = along - squared - std::abs(half.dot(other_half));  // times the length of half
  const double needed = other_radius + within;
  return apart > 0.0 && apart * apart >= squared * needed * needed * (1.0 + 1e-9);
}

}  // namespace

Sphere sphere_around(const Body& body) {
  const Sphere sphere = body.shape.bounding_sphere();
  return {body.link_from_shape * sphere.center, sphere.radius * (1.0 + 1e-9)};
}

NearPairs::NearPairs(const Robot& robot, const std::function<double(const BodyPair&)>& within) {
  for (const Body& body : robot.bodies) {
    bodies_.push_back({&body, sphere_around(body), body.shape.is_axial(),
                       0.5 * body.shape.length() * body.link_from_shape.linear().col(2)});
  }
  for (const BodyPair& pair : self_collision_pairs(robot)) {
    const Placed& first = bodies_[static_cast<std::size_t>(pair.first)];
    const Placed& second = bodies_[static_cast<std::size_t>(pair.second)];
    const double reach = within(pair), size = first.sphere.radius + second.sphere.radius;
    if (reach < 0.0) continue;
    const double axes = first.body->shape.radius() + second.body->shape.radius() + reach + 1e-6 * size;
    pairs_.push_back({pair.first, pair.second, reach, (size + reach) * (size + reach),
                      first.has_axis && second.has_axis ? axes * axes : 0.0});
  }
  near_.reserve(pairs_.size());
}

std::span<const NearPair> NearPairs::look(const LinkPoses& map_from_link) {
  near_.clear();
  const auto pose = [&](const Placed& placed) -> const Eigen::Isometry3d& {
    return map_from_link[static_cast<std::size_t>(placed.body->link)];
  };
  for (Placed& placed : bodies_) placed.middle = moved(pose(placed), placed.sphere.center);
  for (const Pair& pair : pairs_) {
    if (is_far(pair, map_from_link)) continue;
    const Placed& first = bodies_[static_cast<std::size_t>(pair.first)];
    const Placed& second = bodies_[static_cast<std::size_t>(pair.second)];
    const DistanceBounds bounds =
        distance(first.body->shape, pose(first) * first.body->link_from_shape, second.body->shape,
                 pose(second) * second.body->link_from_shape, pair.within);
    if (bounds.lower >= pair.within) continue;
    NearPair near{pair.first,   pair.second,    first.body->link, second.body->link,
                  bounds.lower, bounds.point_a, bounds.point_b,   bounds.direction};
    if (bounds.direction.squaredNorm() < 0.5) {
      near.direction = (second.middle - first.middle).stableNormalized();
      if (near.direction.squaredNorm() < 0.5) continue;
      near.first_point = first.middle;
      near.second_point = second.middle;
    }
    near_.push_back(near);
  }
  return near_;
}

bool NearPairs::is_far(const Pair& pair, const LinkPoses& map_from_link) const {
  const Placed& first = bodies_[static_cast<std::size_t>(pair.first)];
  const Placed& second = bodies_[static_cast<std::size_t>(pair.second)];
  if ((first.middle - second.middle).squaredNorm() > pair.spheres_apart) return true;
  if (pair.axes_apart == 0.0) return false;
  const auto along = [&](const Placed& placed) -> Eigen::Vector3d {
    return map_from_link[static_cast<std::size_t>(placed.body->link)].linear().lazyProduct(placed.half);
  };
  const Eigen::Vector3d first_half = along(first), second_half = along(second);
  if (squared_segment_gap(first.middle, first_half, second.middle, second_half) >= pair.axes_apart)
    return true;
  return (first.is_flat() && is_beyond_end(first.middle, first_half, second.middle, second_half,
                                           second.body->shape.radius(), pair.within)) ||
         (second.is_flat() && is_beyond_end(second.middle, second_half, first.middle, first_half,
                                            first.body->shape.radius(), pair.within));
}

}  // namespace clearway
