#include "planning/guarded_body.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

constexpr double half_diagonal = 0.8660254037844387;  ///< of a cube of edge 1, rounded up

/// A ball that holds the body: about the middle of its own frame, or of its cover when that is smaller.
Sphere bounding_ball(const Body& body) {
  Sphere ball{body.link_from_shape.translation(), body.shape.bounding_radius()};
  const Eigen::AlignedBox3d box = body.shape.bounds(body.link_from_shape);
  double radius = 0.0;
  for (const Sphere& part : body.cover)
    radius = std::max(radius, (part.center - box.center()).norm() + part.radius);
  if (radius < ball.radius) ball = {box.center(), radius};
  return ball;
}

}  // namespace

GuardedBody::GuardedBody(const Body& body, std::shared_ptr<const BlockedSpace> space,
                         const Eigen::AlignedBox3d& reach)
    : body_(body), space_(std::move(space)), reach_(reach), bound_(bounding_ball(body)) {
  const Eigen::Isometry3d shape_from_link = body.link_from_shape.inverse();
  for (const Sphere& ball : body_.cover) {
    const double surface = body_.shape.signed_distance(shape_from_link * ball.center);
    core_.push_back(body_.shape.kind() != Shape::Kind::convex && surface < 0.0);
    excess_ = std::max(excess_, ball.radius + surface);
  }
}

bool GuardedBody::is_cube_clear(const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                                double margin) const {
  const double edge = space_->resolution();
  const Eigen::Vector3d local = map_from_shape.linear().transpose() * (cube - map_from_shape.translation());
  const double surface = body_.shape.signed_distance(local);
  if (surface > half_diagonal * edge * (1.0 + 1e-9) + margin) return true;
  if (body_.shape.kind() != Shape::Kind::convex && surface <= margin + edge / 2)
    return false;  // ball in the cube
  return distance_to_cube(body_.shape, map_from_shape, cube, edge, margin).lower > margin;
}

bool GuardedBody::is_clear(const Eigen::Isometry3d& map_from_link, double margin) const {
  if (space_->clearance(map_from_link * bound_.center) > bound_.radius + margin) return true;
  struct Query {
    const GuardedBody& self;
    Eigen::Isometry3d map_from_shape;
    double margin;
  } query{*this, map_from_link * body_.link_from_shape, margin};
  Eigen::AlignedBox3d bounds;
  for (std::size_t i = 0; i < body_.cover.size(); ++i) {
    const Eigen::Vector3d center = map_from_link * body_.cover[i].center;
    const double reach = body_.cover[i].radius + margin;
    if (space_->clearance(center) > reach) continue;
    if (core_[i] && space_->is_blocked(center)) return false;
    if (bounds.isEmpty()) {
      bounds = body_.shape.bounds(query.map_from_shape);
      bounds.min().array() -= margin;
      bounds.max().array() += margin;
      bounds = bounds.intersection(reach_);
    }
    // Whatever is within the margin of the body is within the margin of a ball that was not clear.
    Eigen::AlignedBox3d box(center - Eigen::Vector3d::Constant(reach),
                            center + Eigen::Vector3d::Constant(reach));
    box = box.intersection(bounds);
    if (box.isEmpty()) continue;
    const bool clear = space_->visit_blocked(box, [&query](const Eigen::Vector3d& cube) {
      return query.self.is_cube_clear(query.map_from_shape, cube, query.margin);
    });
    if (!clear) return false;
  }
  return true;
}

double GuardedBody::quick_clearance(const Eigen::Isometry3d& map_from_link) const {
  const double bound = space_->clearance(map_from_link * bound_.center) - bound_.radius;
  double least = space_->max_distance();
  if (bound >= least) return least;
  for (const Sphere& ball : body_.cover) {
    least = std::min(least, space_->clearance(map_from_link * ball.center) - ball.radius);
  }
  return std::max(bound, least);
}

bool GuardedBody::visit_near(const Eigen::Isometry3d& map_from_link, double margin,
                             const std::function<bool(const Eigen::Vector3d&, double)>& visit) const {
  const Eigen::Vector3d middle = map_from_link * bound_.center;
  if (space_->clearance(middle) > bound_.radius + margin) return true;
  struct Query {
    const GuardedBody& self;
    Eigen::Isometry3d map_from_shape;
    double margin;
    const std::function<bool(const Eigen::Vector3d&, double)>& visit;
  } query{*this, map_from_link * body_.link_from_shape, margin, visit};
  Eigen::AlignedBox3d box = body_.shape.bounds(query.map_from_shape);
  box.min().array() -= margin;
  box.max().array() += margin;
  box = box.intersection(reach_);
  if (box.isEmpty()) return true;
  return space_->visit_blocked(box, [&query](const Eigen::Vector3d& cube) {
    const GuardedBody& self = query.self;
    const Eigen::Isometry3d& pose = query.map_from_shape;
    const double surface =
        self.body_.shape.signed_distance(pose.linear().transpose() * (cube - pose.translation()));
    const double least = surface - half_diagonal * self.space_->resolution() * (1.0 + 1e-9);
    return least > query.margin || query.visit(cube, std::max(least, 0.0));
  });
}

double GuardedBody::exact_clearance(const Eigen::Isometry3d& map_from_link, double limit) const {
  const Eigen::Isometry3d map_from_shape = map_from_link * body_.link_from_shape;
  double least = limit;
  visit_near(map_from_link, limit, [&](const Eigen::Vector3d& cube, double bound) {
    if (bound >= least) return true;
    least = std::min(least,
                     distance_to_cube(body_.shape, map_from_shape, cube, space_->resolution(), least).lower);
    return least > 0.0;
  });
  return least;
}

}  // namespace clearway
