#include "planning/constraint/near_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

bool has_axis(const Shape& shape) {
  return shape.kind() != Shape::Kind::box && shape.kind() != Shape::Kind::convex;
}

Eigen::Vector3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) {
  return pose.linear().lazyProduct(point) + pose.translation();
}

/// Squared distance of the segments a + s u and b + t v with s and t in [-1, 1] (Ericson, "Real-Time
/// Collision Detection", 2005, sec. 5.1.9). Of segments that are parallel within 1e-7 it may be too large by
/// that share of their length.
double squared_gap(const Eigen::Vector3d& a, const Eigen::Vector3d& u, const Eigen::Vector3d& b,
                   const Eigen::Vector3d& v) {
  const Eigen::Vector3d w = a - b;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const auto on_segment = [](double value) { return std::clamp(value, -1.0, 1.0); };
  const double determinant = uu * vv - uv * uv;
  double s = determinant > 1e-14 * uu * vv ? on_segment((uv * vw - vv * uw) / determinant) : 0.0;
  const double free = vv > 0.0 ? (vw + s * uv) / vv : 0.0, t = on_segment(free);
  if (t != free || determinant <= 1e-14 * uu * vv) s = uu > 0.0 ? on_segment((t * uv - uw) / uu) : 0.0;
  return (w + s * u - t * v).squaredNorm();
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
  const Eigen::Vector3d middle = body.shape.bounds(Eigen::Isometry3d::Identity()).center();
  double radius = body.shape.bounding_radius();
  if (body.shape.kind() == Shape::Kind::convex) {
    radius = 0.0;
    for (const Eigen::Vector3d& corner : body.shape.vertices())
      radius = std::max(radius, (corner - middle).norm());
  }
  return {body.link_from_shape * middle, radius * (1.0 + 1e-9)};
}

NearPairs::NearPairs(const Robot& robot, const std::function<double(const BodyPair&)>& within) {
  for (const Body& body : robot.bodies) {
    const double length = body.shape.kind() == Shape::Kind::sphere ? 0.0 : body.shape.length();
    bodies_.push_back({&body, sphere_around(body), has_axis(body.shape),
                       0.5 * length * body.link_from_shape.linear().col(2)});
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
  if (squared_gap(first.middle, first_half, second.middle, second_half) >= pair.axes_apart) return true;
  return (first.is_flat() && is_beyond_end(first.middle, first_half, second.middle, second_half,
                                           second.body->shape.radius(), pair.within)) ||
         (second.is_flat() && is_beyond_end(second.middle, second_half, first.middle, first_half,
                                            first.body->shape.radius(), pair.within));
}

}  // namespace clearway
