#include "planning/space/body_collision.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::atomic<std::uint64_t> bodies_made = 0;

/// A sphere that holds the body: about the middle of its own frame, or of its cover when that is smaller.
Sphere bounding_sphere(const Body& body) {
  Sphere sphere{body.link_from_shape.translation(), body.shape.bounding_radius()};
  const Eigen::AlignedBox3d box = body.shape.bounds(body.link_from_shape);
  double radius = 0.0;
  for (const Sphere& part : body.cover)
    radius = std::max(radius, (part.center - box.center()).norm() + part.radius);
  if (radius < sphere.radius) sphere = {box.center(), radius};
  return sphere;
}

/// Points of the shape, its frame: one in its middle, then those farthest in some 100 directions, drawn a
/// millionth towards the middle.
std::vector<Eigen::Vector3d> inner_points(const Shape& shape) {
  std::vector<Eigen::Vector3d> skin;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const double same = 1e-12 * shape.bounding_radius() * shape.bounding_radius();
  const bool is_sphere = shape.is_rounded() && shape.length() == 0.0;  // no point twice
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (std::gcd(std::gcd(x, y), z) != 1) continue;  // twice another direction, or none
        const Eigen::Vector3d point = shape.support(Eigen::Vector3d(x, y, z));
        const bool known =
            !is_sphere && std::any_of(skin.begin(), skin.end(), [&](const Eigen::Vector3d& other) {
              return (other - point).squaredNorm() < same;
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

/// Directions spread evenly (Fibonacci's spiral).
Eigen::Vector3d direction(int i, int count) {
  const double z = 1.0 - (2.0 * i + 1.0) / count, around = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
  const double across = std::sqrt(1.0 - z * z);
  return {across * std::cos(around), across * std::sin(around), z};
}

/// Who changes a body's shape and not its cover loses what is proved by the cover. A look at the outermost
/// points in many directions finds a cover of another shape, place or size.
void require_cover(const Body& body) {
  constexpr int directions = 100;
  for (int i = 0; i < directions; ++i) {
    const Eigen::Vector3d point = body.link_from_shape * body.shape.support(direction(i, directions));
    const double rounding = 1e-9 * (1.0 + point.norm());
    const auto holds = [&](const Sphere& sphere) {
      return (point - sphere.center).norm() <= sphere.radius + rounding;
    };
    if (std::none_of(body.cover.begin(), body.cover.end(), holds))
      throw std::invalid_argument("a body of part " + quote(body.part) +
                                  " has a cover that does not hold its shape, expected the spheres of its "
                                  "shape's sphere_cover(), in the frame of its link");
  }
}

}  // namespace

BodyGeometry::BodyGeometry(const Body& given) : body(given), bound(bounding_sphere(given)) {
  require_cover(body);
  for (const Eigen::Vector3d& point : inner_points(body.shape))
    witnesses.push_back(body.link_from_shape * point);
  const Eigen::Isometry3d shape_from_link = body.link_from_shape.inverse();
  for (const Sphere& sphere : body.cover) {
    const double surface = body.shape.signed_distance(shape_from_link * sphere.center);
    core.push_back(body.shape.has_exact_distance() && surface < 0.0);
    excess = std::max(excess, sphere.radius + surface);
    spread = std::max(spread, (sphere.center - bound.center).norm());
  }
}

BodyCollision::BodyCollision(std::shared_ptr<const BodyGeometry> geometry,
                             std::shared_ptr<const BlockedSpace> space, const Eigen::AlignedBox3d& reach)
    : id_(++bodies_made), geometry_(std::move(geometry)), space_(std::move(space)), reach_(reach) {}

/// Steps of projecting to and fro between body and cube, which draws near to their nearest points. At each,
/// the plane through the body's point, square to the way to the cube's, has the body on one side; and the
/// body is as near to the cube as its point. The next point of the cube is taken beyond the nearest one,
/// where bodies that overlap are soon found to.
BodyCollision::Sight BodyCollision::look_at(const Eigen::Isometry3d& map_from_shape,
                                            const Eigen::Vector3d& cube, double margin, int looks) const {
  const double half = 0.5 * space_->resolution();
  const auto turned = map_from_shape.linear();
  Eigen::Vector3d point = cube;  // of the cube
  for (int look = 0; look < looks; ++look) {
    const Eigen::Vector3d local =
        body().shape.offset_to(turned.transpose() * (point - map_from_shape.translation()));
    const double distance = local.norm();
    const double rounding = 1e-12 * (cube.cwiseAbs().maxCoeff() + distance + half);
    if (look == 0 && distance - 2.0 * half_diagonal * half > margin + rounding) return Sight::clear;
    const Eigen::Vector3d offset = turned * local;
    const Eigen::Vector3d on_body = point - offset;
    if (distance > 0.0) {
      const double gap = (offset.dot(cube - on_body) - half * offset.cwiseAbs().sum()) / distance;
      if (gap > margin + rounding) return Sight::clear;
    }
    if (!body().shape.has_exact_distance()) return Sight::unsure;  // the point is of the box around it
    const Eigen::Vector3d nearest = cube + (on_body - cube).cwiseMax(-half).cwiseMin(half);
    const double beyond = (on_body - nearest).norm();
    if (beyond + rounding <= margin || beyond == 0.0) return Sight::met;
    point = cube + (nearest + 2.0 * (nearest - on_body) - cube).cwiseMax(-half).cwiseMin(half);
  }
  return Sight::unsure;
}

bool BodyCollision::is_far(const Eigen::Vector3d& point, double distance) const {
  return space_->coarse_clearance(point) > distance || space_->clearance(point) > distance;
}

bool BodyCollision::is_pierced(const Eigen::Isometry3d& map_from_link) const {
  return std::any_of(
      geometry_->witnesses.begin(), geometry_->witnesses.end(),
      [&](const Eigen::Vector3d& witness) { return space_->is_blocked(map_from_link * witness); });
}

void RecentCubes::remember(const Eigen::Vector3d& cube) {
  std::size_t place = 0;
  while (place < size_ && cubes_[place] != cube) ++place;
  if (place == size_) size_ = std::min(size_ + 1, most);
  for (place = std::min(place, size_ - 1); place > 0; --place) cubes_[place] = cubes_[place - 1];
  cubes_[0] = cube;
}

bool BodyCollision::is_met(const Eigen::Isometry3d& map_from_link, double margin, RecentCubes& recent) const {
  const Eigen::Isometry3d map_from_shape = map_from_link * body().link_from_shape;
  for (std::size_t i = 0; i < recent.size(); ++i) {
    if (look_at(map_from_shape, recent[i], margin, 4) != Sight::met) continue;
    recent.remember(Eigen::Vector3d(recent[i]));
    return true;
  }
  return false;
}

bool BodyCollision::is_clear_of(const Eigen::Isometry3d& map_from_link, const Eigen::Vector3d& cube,
                                double margin) const {
  const Eigen::Isometry3d map_from_shape = map_from_link * body().link_from_shape;
  const Sight sight = look_at(map_from_shape, cube, margin, projections);
  if (sight != Sight::unsure) return sight == Sight::clear;
  return distance_to_cube(body().shape, map_from_shape, cube, space_->resolution(), margin).lower > margin;
}

std::optional<Eigen::Vector3d> BodyCollision::met_cube(const Eigen::Isometry3d& map_from_link,
                                                       double margin) const {
  std::vector<Eigen::Vector3d> inside = geometry_->witnesses;
  for (std::size_t i = 0; i < geometry_->core.size(); ++i)
    if (geometry_->core[i]) inside.push_back(body().cover[i].center);
  const double edge = space_->resolution();
  for (const Eigen::Vector3d& point : inside) {
    const Eigen::Vector3d at = map_from_link * point;
    if (space_->is_blocked(at)) return ((at.array() / edge).floor() + 0.5) * edge;
  }
  RecentCubes met;
  if (is_clear(map_from_link, margin, &met) || met.size() == 0) return std::nullopt;
  return met[0];
}

double BodyCollision::quick_clearance(const Eigen::Isometry3d& map_from_link) const {
  const double bound = space_->clearance(map_from_link * geometry_->bound.center) - geometry_->bound.radius;
  double least = space_->max_distance();
  if (bound >= least) return least;
  for (const Sphere& sphere : body().cover) {
    least = std::min(least, space_->clearance(map_from_link * sphere.center) - sphere.radius);
  }
  return std::max(bound, least);
}

bool BodyCollision::visit_near(const Eigen::Isometry3d& map_from_link, double margin,
                               const std::function<bool(const Eigen::Vector3d&, double)>& visit,
                               bool only_in_reach) const {
  const Eigen::Vector3d middle = map_from_link * geometry_->bound.center;
  if (space_->clearance(middle) > geometry_->bound.radius + margin) return true;
  struct Query {
    const BodyCollision& self;
    Eigen::Isometry3d map_from_shape;
    double margin;
    const std::function<bool(const Eigen::Vector3d&, double)>& visit;
  } query{*this, map_from_link * body().link_from_shape, margin, visit};
  Eigen::AlignedBox3d box = body().shape.bounds(query.map_from_shape);
  box.min().array() -= margin;
  box.max().array() += margin;
  if (only_in_reach) box = box.intersection(reach_);
  if (box.isEmpty()) return true;
  return space_->visit_blocked(box, [&query](const Eigen::Vector3d& cube) {
    const BodyCollision& self = query.self;
    const Eigen::Isometry3d& pose = query.map_from_shape;
    const double surface =
        self.body().shape.signed_distance(pose.linear().transpose() * (cube - pose.translation()));
    const double least = surface - half_diagonal * self.space_->resolution() * (1.0 + 1e-9);
    return least > query.margin || query.visit(cube, std::max(least, 0.0));
  });
}

double BodyCollision::exact_clearance(const Eigen::Isometry3d& map_from_link, double limit) const {
  const Eigen::Isometry3d map_from_shape = map_from_link * body().link_from_shape;
  double least = limit;
  const auto lower_least = [&](const Eigen::Vector3d& cube, double bound) {
    if (bound >= least) return true;
    least = std::min(least,
                     distance_to_cube(body().shape, map_from_shape, cube, space_->resolution(), least).lower);
    return least > 0.0;
  };
  visit_near(map_from_link, limit, lower_least, false);
  return least;
}

}  // namespace clearway
