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

/// Points of the shape, its frame: one in its middle, then those farthest in some 100 directions, drawn a
/// millionth towards the middle.
std::vector<Eigen::Vector3d> inner_points(const Shape& shape) {
  std::vector<Eigen::Vector3d> skin;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Eigen::Vector3d point = shape.support(Eigen::Vector3d(x, y, z));
        const bool known = std::any_of(skin.begin(), skin.end(), [&](const Eigen::Vector3d& other) {
          return (other - point).squaredNorm() < 1e-12 * shape.bounding_radius() * shape.bounding_radius();
        });
        if (!known) skin.push_back(point);
      }
    }
  }
  for (const Eigen::Vector3d& point : skin) middle += point / static_cast<double>(skin.size());
  std::vector<Eigen::Vector3d> points{middle};
  for (const Eigen::Vector3d& point : skin) points.push_back(point + 1e-6 * (middle - point));
  return points;
}

}  // namespace

GuardedBody::GuardedBody(const Body& body, std::shared_ptr<const BlockedSpace> space,
                         const Eigen::AlignedBox3d& reach)
    : body_(body), space_(std::move(space)), reach_(reach), bound_(bounding_ball(body)) {
  for (const Eigen::Vector3d& point : inner_points(body.shape))
    witnesses_.push_back(body.link_from_shape * point);
  const Eigen::Isometry3d shape_from_link = body.link_from_shape.inverse();
  for (const Sphere& ball : body_.cover) {
    const double surface = body_.shape.signed_distance(shape_from_link * ball.center);
    core_.push_back(body_.shape.kind() != Shape::Kind::convex && surface < 0.0);
    excess_ = std::max(excess_, ball.radius + surface);
  }
}

/// What the nearest point of the body to the cube's centre tells of the distance to the cube: the plane
/// through it, square to the way to the centre, has the body on one side; and the point itself is as near as
/// it is.
GuardedBody::Sight GuardedBody::look_at(const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                                        double margin) const {
  const double half = 0.5 * space_->resolution();
  const auto turned = map_from_shape.linear();
  const Eigen::Vector3d offset =
      turned * body_.shape.offset_to(turned.transpose() * (cube - map_from_shape.translation()));
  const double distance = offset.norm();
  const double gap = distance - half * offset.cwiseAbs().sum() / std::max(distance, 1e-300);
  const double rounding = 1e-12 * (cube.cwiseAbs().maxCoeff() + distance + half);
  if (distance > 0.0 && gap > margin + rounding) return Sight::clear;
  if (body_.shape.kind() == Shape::Kind::convex) return Sight::unsure;  // the point is of the box around it
  const double beyond = (offset.cwiseAbs().array() - half).max(0.0).matrix().norm();
  return beyond + rounding <= margin || beyond == 0.0 ? Sight::met : Sight::unsure;
}

bool GuardedBody::is_far(const Eigen::Vector3d& point, double distance) const {
  return space_->coarse_clearance(point) > distance || space_->clearance(point) > distance;
}

bool GuardedBody::is_pierced(const Eigen::Isometry3d& map_from_link) const {
  return std::any_of(witnesses_.begin(), witnesses_.end(), [&](const Eigen::Vector3d& witness) {
    return space_->is_blocked(map_from_link * witness);
  });
}

bool GuardedBody::is_clear(const Eigen::Isometry3d& map_from_link, double margin) const {
  if (is_far(map_from_link * bound_.center, bound_.radius + margin)) return true;
  // Whatever is within the margin of the body is within the margin of a ball that is not clear.
  thread_local std::vector<Eigen::AlignedBox3d> boxes;
  thread_local std::vector<Eigen::Vector3d> unsure;
  boxes.clear();
  unsure.clear();
  double volume = 0.0;
  Eigen::AlignedBox3d whole;
  for (std::size_t i = 0; i < body_.cover.size(); ++i) {
    const Eigen::Vector3d center = map_from_link * body_.cover[i].center;
    const double reach = body_.cover[i].radius + margin;
    if (is_far(center, reach)) continue;
    if (boxes.empty() && is_pierced(map_from_link)) return false;
    if (core_[i] && space_->is_blocked(center)) return false;
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(reach);
    boxes.emplace_back(center - around, center + around);
    volume += boxes.back().volume();
    whole.extend(boxes.back());
  }
  if (boxes.empty()) return true;
  struct Query {
    const GuardedBody& self;
    Eigen::Isometry3d map_from_shape;
    double margin;
    std::vector<Eigen::Vector3d>& unsure;
  } query{*this, map_from_link * body_.link_from_shape, margin, unsure};
  Eigen::AlignedBox3d bounds = body_.shape.bounds(query.map_from_shape);
  bounds.min().array() -= margin;
  bounds.max().array() += margin;
  bounds = bounds.intersection(reach_);
  whole = whole.intersection(bounds);
  if (whole.volume() <= volume) boxes.assign(1, whole);
  // The body's middle is not blocked and the body, grown by the margin, is convex: it cannot reach a blocked
  // voxel without meeting one of the surface.
  const bool none_met = std::all_of(boxes.begin(), boxes.end(), [&](const Eigen::AlignedBox3d& box) {
    return space_->visit_surface(box.intersection(bounds), [&query](const Eigen::Vector3d& cube) {
      const Sight sight = query.self.look_at(query.map_from_shape, cube, query.margin);
      if (sight == Sight::unsure) query.unsure.push_back(cube);
      return sight != Sight::met;
    });
  });
  return none_met && std::all_of(unsure.begin(), unsure.end(), [&](const Eigen::Vector3d& cube) {
           return distance_to_cube(body_.shape, query.map_from_shape, cube, space_->resolution(), margin)
                      .lower > margin;
         });
}

/// A plane between the cube and the body at both poses, square to the way from the body at one of them.
bool GuardedBody::is_sweep_past(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end,
                                const Eigen::Vector3d& cube, double margin) const {
  const double half = 0.5 * space_->resolution();
  for (const Eigen::Isometry3d* pose : {&begin, &end}) {
    const auto turned = pose->linear();
    const Eigen::Vector3d offset =
        turned * body_.shape.offset_to(turned.transpose() * (cube - pose->translation()));
    const double distance = offset.norm();
    if (distance <= half) continue;
    const Eigen::Vector3d n = offset / distance;
    const auto farthest = [&](const Eigen::Isometry3d& at) {
      return n.dot(at.translation() - cube) +
             (at.linear().transpose() * n).dot(body_.shape.support(at.linear().transpose() * n));
    };
    const double gap = -std::max(farthest(begin), farthest(end)) - half * n.cwiseAbs().sum();
    if (gap > margin + 1e-12 * (1.0 + (begin.translation() - cube).norm() + cube.cwiseAbs().maxCoeff()))
      return true;
  }
  return swept_distance_to_cube(body_.shape, begin, end, cube, space_->resolution(), margin).lower > margin;
}

bool GuardedBody::is_sweep_clear(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end,
                                 double margin) const {
  const auto is_ball_clear = [&](const Sphere& ball, Eigen::AlignedBox3d* box) {
    const Eigen::Vector3d from = begin * ball.center, to = end * ball.center;
    const double reach = ball.radius + margin;
    if (is_far((from + to) / 2, reach + (to - from).norm() / 2 * (1.0 + 1e-9))) return true;
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(reach);
    if (box != nullptr) *box = {from.cwiseMin(to) - around, from.cwiseMax(to) + around};
    return false;
  };
  if (is_ball_clear(bound_, nullptr)) return true;
  struct Query {
    const GuardedBody& self;
    Eigen::Isometry3d begin, end;  ///< map_from_shape
    double margin;
  } query{*this, begin * body_.link_from_shape, end * body_.link_from_shape, margin};
  Eigen::AlignedBox3d bounds = body_.shape.bounds(query.begin).merged(body_.shape.bounds(query.end));
  bounds.min().array() -= margin;
  bounds.max().array() += margin;
  bounds = bounds.intersection(reach_);
  Eigen::AlignedBox3d box;
  bool is_known_outside = false;
  for (const Sphere& ball : body_.cover) {
    if (is_ball_clear(ball, &box)) continue;
    // As in is_clear: the hull is convex, and its first point is not blocked.
    if (!is_known_outside && space_->is_blocked(begin * witnesses_[0])) return false;
    is_known_outside = true;
    const bool clear = space_->visit_surface(box.intersection(bounds), [&query](const Eigen::Vector3d& cube) {
      return query.self.is_sweep_past(query.begin, query.end, cube, query.margin);
    });
    if (!clear) return false;
  }
  return true;
}

bool GuardedBody::is_quickly_clear(const Eigen::Isometry3d& map_from_link, double margin) const {
  return is_far(map_from_link * bound_.center, bound_.radius + margin) ||
         std::all_of(body_.cover.begin(), body_.cover.end(), [&](const Sphere& ball) {
           return is_far(map_from_link * ball.center, ball.radius + margin);
         });
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
