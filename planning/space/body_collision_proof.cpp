// The proofs that a body, or the hull of a body at two poses, keeps clear of blocked cubes.

#include <algorithm>
#include <functional>
#include <span>

#include "planning/geometry/sweep_beyond.hpp"
#include "planning/space/body_collision.hpp"

namespace clearway {
namespace {

constexpr double coarse_by_voxels = 1.75;  ///< that coarse clearances are too small, at most
constexpr int sweep_projections = 4;  ///< to and fro before GJK: those that succeed do so at once, as a rule

/// Memory of one look, kept per thread.
struct Scratch {
  std::uint64_t body = 0;  ///< whose spheres were looked up, 0: nobody's
  Eigen::Isometry3d pose;  ///< at which
  std::vector<double> x, y, z, coarse,
      close;                               ///< their centres and clearances; close: negative till looked up
  std::vector<Eigen::AlignedBox3d> boxes;  ///< about spheres that are not clear
  std::vector<std::size_t> spheres;        ///< those, by number
  std::vector<double> reaches;             ///< how far these are not, metres
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

/// Coarse clearances of the spheres' centres, if they are not known from the last look.
void BodyCollision::look_up_spheres(const Eigen::Isometry3d& map_from_link) const {
  Scratch& memory = scratch();
  if (memory.body == id_ && memory.pose.matrix() == map_from_link.matrix()) return;
  memory.body = 0;  // should a look-up throw
  const std::size_t count = body().cover.size();
  for (std::vector<double>* values : {&memory.x, &memory.y, &memory.z, &memory.coarse}) values->resize(count);
  memory.close.assign(count, -1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d center = map_from_link * body().cover[i].center;
    memory.x[i] = center.x(), memory.y[i] = center.y(), memory.z[i] = center.z();
  }
  space_->coarse_clearances({memory.x, memory.y, memory.z}, memory.coarse);
  memory.pose = map_from_link;
  memory.body = id_;
}

/// Of a sphere that was looked up.
double BodyCollision::close_clearance(std::size_t sphere) const {
  Scratch& memory = scratch();
  double& close = memory.close[sphere];
  if (close < 0.0) close = space_->clearance({memory.x[sphere], memory.y[sphere], memory.z[sphere]});
  return close;
}

bool BodyCollision::is_sphere_far(std::size_t sphere, double distance) const {
  const double coarse = scratch().coarse[sphere];
  if (coarse > distance) return true;
  const double closer = coarse_by_voxels * space_->resolution();  // no closer look finds more than that
  return coarse + closer > distance && close_clearance(sphere) > distance;
}

bool BodyCollision::is_quickly_clear(const Eigen::Isometry3d& map_from_link, double margin) const {
  if (is_far(map_from_link * geometry_->bound.center, geometry_->bound.radius + margin)) return true;
  look_up_spheres(map_from_link);
  for (std::size_t i = 0; i < body().cover.size(); ++i) {
    if (!is_sphere_far(i, body().cover[i].radius + margin)) return false;
  }
  return true;
}

/// Whatever is within the margin of the body, where its spheres were looked up, is within it of a sphere that
/// is not clear. Finds these.
void BodyCollision::find_near_spheres(double margin) const {
  Scratch& memory = scratch();
  memory.boxes.clear();
  memory.spheres.clear();
  for (std::size_t i = 0; i < body().cover.size(); ++i) {
    const double reach = body().cover[i].radius + margin;
    if (is_sphere_far(i, reach)) continue;
    const Eigen::Vector3d center(memory.x[i], memory.y[i], memory.z[i]);
    memory.boxes.push_back(grown({center, center}, reach));
    memory.spheres.push_back(i);
  }
}

/// The same for the hull of the body at two poses, the spheres looked up at the middle: a sphere's way from
/// one pose to the other is within the farther one of its ends of where it is in the middle. A closer look at
/// spheres costs more than one at the cubes about them.
void BodyCollision::find_near_spheres(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& middle,
                                      const Eigen::Isometry3d& end, double margin) const {
  look_up_spheres(middle);
  Scratch& memory = scratch();
  memory.boxes.clear();
  memory.spheres.clear();
  memory.reaches.clear();
  double travel = 0.0;  // of any centre, at most
  for (const Eigen::Isometry3d* pose : {&begin, &end})
    travel = std::max(travel, (*pose * geometry_->bound.center - middle * geometry_->bound.center).norm() +
                                  (pose->linear() - middle.linear()).norm() * geometry_->spread);
  travel *= 1.0 + 1e-9;
  for (std::size_t i = 0; i < body().cover.size(); ++i) {
    const Sphere& sphere = body().cover[i];
    if (memory.coarse[i] > sphere.radius + margin + travel) continue;
    const Eigen::Vector3d center(memory.x[i], memory.y[i], memory.z[i]);
    const Eigen::Vector3d from = begin * sphere.center, to = end * sphere.center;
    const double way = std::sqrt(std::max((from - center).squaredNorm(), (to - center).squaredNorm()));
    const double reach = sphere.radius + margin + way * (1.0 + 1e-9);
    if (memory.coarse[i] > reach) continue;
    memory.boxes.push_back(grown({from.cwiseMin(to), from.cwiseMax(to)}, sphere.radius + margin));
    memory.spheres.push_back(i);
    memory.reaches.push_back(reach);
  }
}

bool BodyCollision::is_clear(const Eigen::Isometry3d& map_from_link, double margin,
                             RecentCubes* recent) const {
  if (is_far(map_from_link * geometry_->bound.center, geometry_->bound.radius + margin)) return true;
  if (recent != nullptr && is_met(map_from_link, margin, *recent)) return false;
  return is_proved_clear(map_from_link, margin, recent);
}

double BodyCollision::clearance_beyond(const Eigen::Isometry3d& map_from_link, double padding, double margin,
                                       RecentCubes& recent) const {
  const double bound =
      space_->coarse_clearance(map_from_link * geometry_->bound.center) - geometry_->bound.radius;
  if (bound >= std::max(geometry_->bound.radius, margin)) return bound;  // the spheres would hardly say more
  if (is_met(map_from_link, padding, recent)) return -1.0;
  const double quick = std::max(bound, cover_clearance(map_from_link));
  if (quick >= margin) return quick;
  if (is_proved_clear(map_from_link, margin, &recent)) return margin;
  if (quick > padding) return quick;
  if (recent.size() > 0 && !is_clear_of(map_from_link, recent[0], padding)) return -1.0;
  return is_proved_clear(map_from_link, padding, &recent) ? padding : -1.0;
}

double BodyCollision::coarse_clearance(const Eigen::Isometry3d& map_from_link) const {
  const double bound =
      space_->coarse_clearance(map_from_link * geometry_->bound.center) - geometry_->bound.radius;
  if (bound >= geometry_->bound.radius) return bound;  // the spheres would hardly say more
  return std::max(bound, cover_clearance(map_from_link));
}

/// Looks the spheres up and returns what they prove.
double BodyCollision::cover_clearance(const Eigen::Isometry3d& map_from_link) const {
  look_up_spheres(map_from_link);
  const Scratch& memory = scratch();
  double least = space_->max_distance();
  for (std::size_t i = 0; i < body().cover.size(); ++i)
    least = std::min(least, memory.coarse[i] - body().cover[i].radius);
  return least;
}

/// is_clear by looking at the cubes near spheres.
bool BodyCollision::is_proved_clear(const Eigen::Isometry3d& map_from_link, double margin,
                                    RecentCubes* recent) const {
  look_up_spheres(map_from_link);
  find_near_spheres(margin);
  Scratch& memory = scratch();
  if (memory.boxes.empty()) return true;
  if (recent == nullptr ? is_pierced(map_from_link)
                        : space_->is_blocked(map_from_link * geometry_->witnesses[0]))
    return false;
  for (const std::size_t i : memory.spheres) {
    if (geometry_->core[i] && space_->is_blocked({memory.x[i], memory.y[i], memory.z[i]})) return false;
  }
  struct Query {
    const BodyCollision& self;
    Eigen::Isometry3d map_from_shape;
    double margin;
    std::vector<Eigen::Vector3d>& unsure;
    Eigen::Vector3d met;
  } query{*this, map_from_link * body().link_from_shape, margin, memory.unsure, {}};
  query.unsure.clear();
  const Eigen::AlignedBox3d bounds =
      grown(body().shape.bounds(query.map_from_shape), margin).intersection(reach_);
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
        return distance_to_cube(body().shape, query.map_from_shape, cube, space_->resolution(), margin)
                   .lower > margin;
      });
  if (!is_free && recent != nullptr) recent->remember(query.met);
  return is_free;
}

/// A body on its way from one pose to another.
struct BodyCollision::Sweep {
  Eigen::Isometry3d begin, middle, end;  ///< map_from_shape
  double margin;
  double travel;  ///< of any point of the body at most, from the middle to either end
};

/// As look_at, for the hull of the body at both poses: its point is of the segment between the nearest points
/// at either, and the plane has to have the body on one side at both.
bool BodyCollision::is_sweep_past(const Sweep& sweep, const Eigen::Vector3d& cube) const {
  const double half = 0.5 * space_->resolution();
  const double rounding =
      1e-12 * (1.0 + (sweep.begin.translation() - cube).norm() + cube.cwiseAbs().maxCoeff());
  const auto nearest_at = [&](const Eigen::Isometry3d& pose,
                              const Eigen::Vector3d& point) -> Eigen::Vector3d {
    const auto turned = pose.linear();
    return point - turned * body().shape.offset_to(turned.transpose() * (point - pose.translation()));
  };
  // At either end no point of the body, which is convex, is farther than its travel from the body in the
  // middle, nor is any of the hull.
  if ((cube - nearest_at(sweep.middle, cube)).norm() - 2.0 * half_diagonal * half >
      sweep.margin + sweep.travel + rounding)
    return true;
  Eigen::Vector3d point = cube, towards = cube - sweep.middle.translation();
  for (int projection = 0; projection < sweep_projections; ++projection) {
    const Eigen::Vector3d from = nearest_at(sweep.begin, point);
    const Eigen::Vector3d way = nearest_at(sweep.end, point) - from;
    const double share = std::clamp((point - from).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
    const Eigen::Vector3d on_hull = from + share * way;
    const Eigen::Vector3d offset = point - on_hull;
    const double distance = offset.norm();
    if (distance > 0.0) {
      const Eigen::Vector3d n = offset / distance;
      towards = n;
      const auto farthest = [&](const Eigen::Isometry3d& at) {
        const Eigen::Vector3d direction = at.linear().transpose() * n;
        return n.dot(at.translation() - cube) + direction.dot(body().shape.support(direction));
      };
      const double gap = -std::max(farthest(sweep.begin), farthest(sweep.end)) - half * n.cwiseAbs().sum();
      if (gap > sweep.margin + rounding) return true;
    }
    const Eigen::Vector3d nearest = cube + (on_hull - cube).cwiseMax(-half).cwiseMin(half);
    const double beyond = (on_hull - nearest).norm();
    const bool is_of_body = body().shape.has_exact_distance();  // else of the boxes around it
    if (is_of_body && (beyond + rounding <= sweep.margin || beyond == 0.0)) return false;
    point = cube + (nearest + 2.0 * (nearest - on_hull) - cube).cwiseMax(-half).cwiseMin(half);
  }
  return is_sweep_beyond(body().shape, sweep.begin, sweep.end, cube, space_->resolution(), towards,
                         sweep.margin);
}

bool BodyCollision::is_sweep_clear(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& middle,
                                   const Eigen::Isometry3d& end, double margin,
                                   RecentCubes& in_the_way) const {
  const Eigen::Vector3d from = begin * geometry_->bound.center, to = end * geometry_->bound.center;
  if (is_far((from + to) / 2, geometry_->bound.radius + margin + (to - from).norm() / 2 * (1.0 + 1e-9)))
    return true;
  find_near_spheres(begin, middle, end, margin);
  Scratch& memory = scratch();
  if (memory.boxes.empty()) return true;
  // As in is_clear: the hull is convex, and its first point is not blocked.
  if (space_->is_blocked(begin * geometry_->witnesses[0])) return false;
  struct Query {
    const BodyCollision& self;
    Sweep sweep;
    std::span<const Eigen::AlignedBox3d> near;
    RecentCubes& in_the_way;
  } query{*this,
          {begin * body().link_from_shape, middle * body().link_from_shape, end * body().link_from_shape,
           margin, 0.0},
          {},
          in_the_way};
  const Sweep& sweep = query.sweep;
  for (const Eigen::Isometry3d* pose : {&sweep.begin, &sweep.end}) {
    const double travel = (pose->translation() - sweep.middle.translation()).norm() +
                          (pose->linear() - sweep.middle.linear()).norm() * body().shape.bounding_radius();
    query.sweep.travel = std::max(sweep.travel, travel * (1.0 + 1e-9));
  }
  const Eigen::AlignedBox3d bounds =
      grown(body().shape.bounds(sweep.begin).merged(body().shape.bounds(sweep.end)), margin)
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
    bool known_clear = true;
    for (std::size_t i = 0; i < query.near.size() && known_clear; ++i)
      known_clear = !query.near[i].intersects(voxel) ||
                    query.self.is_sphere_far(scratch().spheres[i], scratch().reaches[i]);
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

}  // namespace clearway
