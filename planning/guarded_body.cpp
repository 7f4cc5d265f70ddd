#include "planning/guarded_body.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace clearway {
namespace {

constexpr int projections = 4;  ///< to and fro before GJK, which costs some forty of them
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

/// Steps of projecting to and fro between body and cube, which draws near to their nearest points. At each,
/// the plane through the body's point, square to the way to the cube's, has the body on one side; and the
/// body is as near to the cube as its point.
GuardedBody::Sight GuardedBody::look_at(const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                                        double margin, int looks) const {
  const double half = 0.5 * space_->resolution();
  const auto turned = map_from_shape.linear();
  Eigen::Vector3d point = cube;  // of the cube
  for (int look = 0; look < looks; ++look) {
    const Eigen::Vector3d local =
        body_.shape.offset_to(turned.transpose() * (point - map_from_shape.translation()));
    const double distance = local.norm();
    const double rounding = 1e-12 * (cube.cwiseAbs().maxCoeff() + distance + half);
    if (look == 0 && distance - 2.0 * half_diagonal * half > margin + rounding) return Sight::clear;
    const Eigen::Vector3d offset = turned * local;
    const Eigen::Vector3d on_body = point - offset;
    if (distance > 0.0) {
      const double gap = (offset.dot(cube - on_body) - half * offset.cwiseAbs().sum()) / distance;
      if (gap > margin + rounding) return Sight::clear;
    }
    if (body_.shape.kind() == Shape::Kind::convex) return Sight::unsure;  // the point is of the box around it
    const Eigen::Vector3d nearest = cube + (on_body - cube).cwiseMax(-half).cwiseMin(half);
    const double beyond = (on_body - nearest).norm();
    if (beyond + rounding <= margin || beyond == 0.0) return Sight::met;
    point = nearest;
  }
  return Sight::unsure;
}

bool GuardedBody::is_far(const Eigen::Vector3d& point, double distance) const {
  return space_->coarse_clearance(point) > distance || space_->clearance(point) > distance;
}

bool GuardedBody::is_pierced(const Eigen::Isometry3d& map_from_link) const {
  return std::any_of(witnesses_.begin(), witnesses_.end(), [&](const Eigen::Vector3d& witness) {
    return space_->is_blocked(map_from_link * witness);
  });
}

void RecentCubes::remember(const Eigen::Vector3d& cube) {
  std::size_t place = 0;
  while (place < size_ && cubes_[place] != cube) ++place;
  if (place == size_) size_ = std::min(size_ + 1, most);
  for (place = std::min(place, size_ - 1); place > 0; --place) cubes_[place] = cubes_[place - 1];
  cubes_[0] = cube;
}

bool GuardedBody::is_met(const Eigen::Isometry3d& map_from_link, double margin, RecentCubes& recent) const {
  const Eigen::Isometry3d map_from_shape = map_from_link * body_.link_from_shape;
  for (std::size_t i = 0; i < recent.size(); ++i) {
    if (look_at(map_from_shape, recent[i], margin, 1) != Sight::met) continue;
    recent.remember(Eigen::Vector3d(recent[i]));
    return true;
  }
  return false;
}

bool GuardedBody::is_clear_of(const Eigen::Isometry3d& map_from_link, const Eigen::Vector3d& cube,
                              double margin) const {
  const Eigen::Isometry3d map_from_shape = map_from_link * body_.link_from_shape;
  const Sight sight = look_at(map_from_shape, cube, margin, projections);
  if (sight != Sight::unsure) return sight == Sight::clear;
  return distance_to_cube(body_.shape, map_from_shape, cube, space_->resolution(), margin).lower > margin;
}

namespace {

/// Memory of one look, kept per thread.
struct Scratch {
  std::vector<double> x, y, z, clearance;
  std::vector<Eigen::AlignedBox3d> boxes;  ///< about balls that are not clear
  std::vector<std::size_t> balls;          ///< those, by number
  std::vector<Eigen::Vector3d> unsure;
};

Scratch& scratch() {
  thread_local Scratch memory;
  return memory;
}

/// The boxes, within `bounds`; one box around them all when that is no larger than they are together.
std::span<const Eigen::AlignedBox3d> merged(std::vector<Eigen::AlignedBox3d>& boxes,
                                            const Eigen::AlignedBox3d& bounds) {
  double volume = 0.0;
  Eigen::AlignedBox3d whole;
  for (const Eigen::AlignedBox3d& box : boxes) {
    volume += box.volume();
    whole.extend(box);
  }
  whole = whole.intersection(bounds);
  if (whole.volume() <= volume) {
    boxes.push_back(whole);
    return std::span(boxes).last(1);
  }
  for (Eigen::AlignedBox3d& box : boxes) box = box.intersection(bounds);
  return boxes;
}

Eigen::AlignedBox3d grown(Eigen::AlignedBox3d box, double by) {
  return {box.min().array() - by, box.max().array() + by};
}

}  // namespace

/// Coarse clearances of the balls' centres, in the middle between two poses.
void GuardedBody::look_up_balls(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end) const {
  Scratch& memory = scratch();
  for (std::vector<double>* values : {&memory.x, &memory.y, &memory.z, &memory.clearance})
    values->resize(body_.cover.size());
  for (std::size_t i = 0; i < body_.cover.size(); ++i) {
    Eigen::Vector3d center = begin * body_.cover[i].center;
    if (&begin != &end) center = (center + end * body_.cover[i].center) / 2;
    memory.x[i] = center.x(), memory.y[i] = center.y(), memory.z[i] = center.z();
  }
  space_->coarse_clearances({memory.x, memory.y, memory.z}, memory.clearance);
}

/// Whatever is within the margin of the body, or of its hull at two poses, is within it of a ball, or of the
/// way of a ball, that is not clear. Finds these.
void GuardedBody::find_near_balls(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end,
                                  double margin) const {
  Scratch& memory = scratch();
  look_up_balls(begin, end);
  memory.boxes.clear();
  memory.balls.clear();
  const bool rests = &begin == &end;
  const auto reach_of = [&](std::size_t i) {
    const double reach = body_.cover[i].radius + margin;
    if (rests) return reach;
    const Eigen::Vector3d way = end * body_.cover[i].center - begin * body_.cover[i].center;
    return reach + way.norm() / 2 * (1.0 + 1e-9);
  };
  for (std::size_t i = 0; i < body_.cover.size(); ++i) {
    if (memory.clearance[i] > reach_of(i)) continue;
    const Eigen::Vector3d center(memory.x[i], memory.y[i], memory.z[i]);
    if (space_->clearance(center) > reach_of(i)) continue;
    const Eigen::Vector3d from = begin * body_.cover[i].center, to = end * body_.cover[i].center;
    memory.boxes.push_back(grown({from.cwiseMin(to), from.cwiseMax(to)}, body_.cover[i].radius + margin));
    memory.balls.push_back(i);
  }
}

bool GuardedBody::is_clear(const Eigen::Isometry3d& map_from_link, double margin, RecentCubes* recent) const {
  if (is_far(map_from_link * bound_.center, bound_.radius + margin)) return true;
  if (recent != nullptr && is_met(map_from_link, margin, *recent)) return false;
  find_near_balls(map_from_link, map_from_link, margin);
  Scratch& memory = scratch();
  if (memory.boxes.empty()) return true;
  if (recent == nullptr ? is_pierced(map_from_link) : space_->is_blocked(map_from_link * witnesses_[0]))
    return false;
  for (const std::size_t i : memory.balls) {
    if (core_[i] && space_->is_blocked({memory.x[i], memory.y[i], memory.z[i]})) return false;
  }
  struct Query {
    const GuardedBody& self;
    Eigen::Isometry3d map_from_shape;
    double margin;
    std::vector<Eigen::Vector3d>& unsure;
    Eigen::Vector3d met;
  } query{*this, map_from_link * body_.link_from_shape, margin, memory.unsure, {}};
  query.unsure.clear();
  const Eigen::AlignedBox3d bounds =
      grown(body_.shape.bounds(query.map_from_shape), margin).intersection(reach_);
  // The body's middle is not blocked and the body, grown by the margin, is convex: it cannot reach a blocked
  // voxel without meeting one of the surface.
  const auto boxes = merged(memory.boxes, bounds);
  const bool none_met = std::all_of(boxes.begin(), boxes.end(), [&](const Eigen::AlignedBox3d& box) {
    return space_->visit_surface(box, [&query](const Eigen::Vector3d& cube) {
      const Sight sight = query.self.look_at(query.map_from_shape, cube, query.margin, projections);
      if (sight == Sight::unsure) query.unsure.push_back(cube);
      if (sight == Sight::met) query.met = cube;
      return sight != Sight::met;
    });
  });
  const bool is_free =
      none_met && std::all_of(query.unsure.begin(), query.unsure.end(), [&](const auto& cube) {
        query.met = cube;
        return distance_to_cube(body_.shape, query.map_from_shape, cube, space_->resolution(), margin).lower >
               margin;
      });
  if (!is_free && recent != nullptr) recent->remember(query.met);
  return is_free;
}

/// A body on its way from one pose to another.
struct GuardedBody::Sweep {
  Eigen::Isometry3d begin, end;  ///< map_from_shape
  double margin;
  double travel;  ///< of any point of the body at most
};

/// As look_at, for the hull of the body at both poses: its point is of the segment between the nearest points
/// at either, and the plane has to have the body on one side at both.
bool GuardedBody::is_sweep_past(const Sweep& sweep, const Eigen::Vector3d& cube) const {
  const double half = 0.5 * space_->resolution();
  const double rounding =
      1e-12 * (1.0 + (sweep.begin.translation() - cube).norm() + cube.cwiseAbs().maxCoeff());
  const auto nearest_at = [&](const Eigen::Isometry3d& pose,
                              const Eigen::Vector3d& point) -> Eigen::Vector3d {
    const auto turned = pose.linear();
    return point - turned * body_.shape.offset_to(turned.transpose() * (point - pose.translation()));
  };
  Eigen::Vector3d point = cube;
  for (int projection = 0; projection < projections; ++projection) {
    const Eigen::Vector3d from = nearest_at(sweep.begin, point);
    const double far = (point - from).norm();
    // The body lies behind a plane that is so far from the cube's middle, and comes no nearer than by its
    // travel.
    if (projection == 0 && far - sweep.travel > sweep.margin + rounding + half_diagonal * 2.0 * half)
      return true;
    const Eigen::Vector3d way = nearest_at(sweep.end, point) - from;
    const double share = std::clamp((point - from).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
    const Eigen::Vector3d on_hull = from + share * way;
    const Eigen::Vector3d offset = point - on_hull;
    const double distance = offset.norm();
    if (distance > 0.0) {
      const Eigen::Vector3d n = offset / distance;
      const auto farthest = [&](const Eigen::Isometry3d& at) {
        const Eigen::Vector3d direction = at.linear().transpose() * n;
        return n.dot(at.translation() - cube) + direction.dot(body_.shape.support(direction));
      };
      const double gap = -std::max(farthest(sweep.begin), farthest(sweep.end)) - half * n.cwiseAbs().sum();
      if (gap > sweep.margin + rounding) return true;
    }
    const Eigen::Vector3d nearest = cube + (on_hull - cube).cwiseMax(-half).cwiseMin(half);
    const double beyond = (on_hull - nearest).norm();
    const bool is_of_body = body_.shape.kind() != Shape::Kind::convex;  // else of the boxes around it
    if (is_of_body && (beyond + rounding <= sweep.margin || beyond == 0.0)) return false;
    point = nearest;
  }
  return swept_distance_to_cube(body_.shape, sweep.begin, sweep.end, cube, space_->resolution(), sweep.margin)
             .lower > sweep.margin;
}

bool GuardedBody::is_sweep_clear(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end, double margin,
                                 RecentCubes& in_the_way) const {
  const Eigen::Vector3d from = begin * bound_.center, to = end * bound_.center;
  if (is_far((from + to) / 2, bound_.radius + margin + (to - from).norm() / 2 * (1.0 + 1e-9))) return true;
  find_near_balls(begin, end, margin);
  Scratch& memory = scratch();
  if (memory.boxes.empty()) return true;
  // As in is_clear: the hull is convex, and its first point is not blocked.
  if (space_->is_blocked(begin * witnesses_[0])) return false;
  struct Query {
    const GuardedBody& self;
    Sweep sweep;
    std::span<const Eigen::AlignedBox3d> near;
    RecentCubes& in_the_way;
  } query{*this, {begin * body_.link_from_shape, end * body_.link_from_shape, margin, 0.0}, {}, in_the_way};
  const Sweep& sweep = query.sweep;
  query.sweep.travel = ((sweep.begin.translation() - sweep.end.translation()).norm() +
                        (sweep.begin.linear() - sweep.end.linear()).norm() * body_.shape.bounding_radius()) *
                       (1.0 + 1e-9);
  const Eigen::AlignedBox3d bounds =
      grown(body_.shape.bounds(sweep.begin).merged(body_.shape.bounds(sweep.end)), margin)
          .intersection(reach_);
  const std::size_t count = memory.boxes.size();
  memory.boxes.reserve(count + 1);
  const auto boxes = merged(memory.boxes, bounds);
  query.near = std::span(memory.boxes).first(count);
  const auto is_past = [&query](const Eigen::Vector3d& cube) {
    if (query.self.is_sweep_past(query.sweep, cube)) return true;
    const Eigen::Vector3d half =
        Eigen::Vector3d::Constant(0.5 * query.self.space_->resolution() * (1.0 + 1e-9));
    const Eigen::AlignedBox3d voxel(cube - half, cube + half);
    const bool known_clear = std::none_of(query.near.begin(), query.near.end(),
                                          [&](const auto& near) { return near.intersects(voxel); });
    if (!known_clear) query.in_the_way.remember(cube);
    return known_clear;
  };
  for (std::size_t i = 0; i < in_the_way.size(); ++i) {
    if (!is_past(Eigen::Vector3d(in_the_way[i]))) return false;
  }
  return std::all_of(boxes.begin(), boxes.end(), [&](const Eigen::AlignedBox3d& box) {
    return space_->visit_surface(box, std::cref(is_past));
  });
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

double GuardedBody::coarse_clearance(const Eigen::Isometry3d& map_from_link) const {
  const double bound = space_->coarse_clearance(map_from_link * bound_.center) - bound_.radius;
  if (bound >= bound_.radius) return bound;  // the balls of the cover would hardly say more
  look_up_balls(map_from_link, map_from_link);
  const Scratch& memory = scratch();
  double least = space_->max_distance();
  for (std::size_t i = 0; i < body_.cover.size(); ++i)
    least = std::min(least, memory.clearance[i] - body_.cover[i].radius);
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
