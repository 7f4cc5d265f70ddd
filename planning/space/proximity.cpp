// Damper constraints of Lahouar et al. 2006: ConfigurationSpace::proximity_constraints.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

constexpr int directions = 6;  ///< +x -x +y -y +z -z of the map
constexpr int max_pieces = 4;

/// A body's longest axis, cut into pieces about twice as long as the body is wide.
struct LongAxis {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double half_length = 0.0;  ///< of the medial segment: the rest is round or narrow
  int pieces = 1;

  explicit LongAxis(const Shape& shape) {
    const MedialSegment middle = shape.medial_segment();
    axis = middle.axis;
    half_length = middle.half_length;
    const double times_wide = middle.half_extent / std::max(middle.width, 1e-12);
    pieces = std::clamp(static_cast<int>(std::ceil(times_wide)), 1, max_pieces);
  }

  /// Signed place along the axis, and the medial point there.
  double along(const Eigen::Vector3d& in_shape) const {
    return std::clamp(axis.dot(in_shape), -half_length, half_length);
  }
  int piece(double place) const {
    if (half_length <= 0.0) return 0;
    return std::clamp(static_cast<int>((place + half_length) / (2.0 * half_length) * pieces), 0, pieces - 1);
  }
};

/// The map direction that a vector follows most.
int direction_of(const Eigen::Vector3d& v) {
  int axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  return 2 * axis + (v[axis] < 0.0 ? 1 : 0);
}

struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  Eigen::Vector3d cube = Eigen::Vector3d::Zero();
  DistanceBounds bounds;
  Eigen::Vector3d fallback = Eigen::Vector3d::Zero();  ///< direction when the bodies overlap
};

/// The nearest cube for each piece and direction, in that order.
std::array<Nearest, max_pieces * directions> nearest_voxels(const BodyCollision& collision,
                                                            const Eigen::Isometry3d& pose, double reach) {
  const Shape& shape = collision.body().shape;
  const Eigen::Isometry3d map_from_shape = pose * collision.body().link_from_shape;
  const LongAxis medial(shape);
  std::array<Nearest, max_pieces * directions> slots;
  if (collision.is_quickly_clear(pose, reach)) return slots;
  collision.visit_near(pose, reach, [&](const Eigen::Vector3d& cube, double least) {
    const Eigen::Vector3d in_shape =
        map_from_shape.linear().transpose() * (cube - map_from_shape.translation());
    const double place = medial.along(in_shape);
    // Which way the cube lies is given well enough by its centre; inside the body by the medial segment.
    const Eigen::Vector3d from_medial = in_shape - place * medial.axis;
    const Eigen::Vector3d offset = shape.offset_to(in_shape);
    const Eigen::Vector3d way = map_from_shape.linear() * (offset.squaredNorm() > 0.0 ? offset : from_medial);
    Nearest& slot = slots[static_cast<std::size_t>(medial.piece(place) * directions + direction_of(way))];
    const double known = std::min(slot.distance, reach);
    if (least > known) return true;
    const DistanceBounds bounds =
        distance_to_cube(shape, map_from_shape, cube, collision.space().resolution(), known);
    if (bounds.lower >= known) return true;
    slot = {bounds.lower, cube, bounds, way.normalized()};
    return true;
  });
  return slots;
}

}  // namespace

std::vector<ProximityConstraint> ConfigurationSpace::proximity_constraints(const Configuration& q,
                                                                           double influence_distance) const {
  const CollisionModel& model = *model_;
  if (q.size() != static_cast<Eigen::Index>(model.robot.dof()) || !q.allFinite())
    throw std::invalid_argument("proximity constraints: got " + counted(q.size(), "value") + ", expected " +
                                std::to_string(model.robot.dof()) + " finite ones");
  if (std::isnan(influence_distance))
    throw std::invalid_argument("proximity constraints: influence_distance is no number, expected metres");
  const LinkPoses poses = forward_kinematics(model.robot, q);
  std::vector<ProximityConstraint> constraints;
  const auto append = [&](ProximityConstraint constraint) {
    if (constraint.gradient.cwiseAbs().maxCoeff() > 1e-12) constraints.push_back(std::move(constraint));
  };
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const BodyCollision& collision = model.bodies[i];
    const double padding = model.options.padding;
    for (const Nearest& near :
         nearest_voxels(collision, model.pose(poses, i), influence_distance + padding)) {
      if (!std::isfinite(near.distance)) continue;
      ProximityConstraint constraint;
      constraint.distance = near.distance - padding;
      constraint.body = model.indices[i];
      constraint.point = near.bounds.point_a;
      constraint.normal = near.distance > 0.0 ? near.bounds.direction : near.fallback;
      if (near.distance <= 0.0) constraint.point = near.cube;
      constraint.gradient =
          jacobian(model.robot, poses, collision.body().link, constraint.point).topRows<3>().transpose() *
          constraint.normal;
      append(std::move(constraint));
    }
  }
  for (const BodyPair& pair : model.pairs) {
    if (is_apart(model.robot, pair, poses, influence_distance)) continue;
    const DistanceBounds bounds = pair_distance(model.robot, pair, poses);
    if (bounds.direction.isZero(0.0)) continue;
    const int link_a = model.robot.bodies[static_cast<std::size_t>(pair.first)].link;
    const int link_b = model.robot.bodies[static_cast<std::size_t>(pair.second)].link;
    ProximityConstraint constraint;
    constraint.distance = bounds.lower;
    constraint.body = pair.first;
    constraint.point = bounds.point_a;
    constraint.normal = bounds.direction;
    constraint.gradient = (jacobian(model.robot, poses, link_a, bounds.point_a) -
                           jacobian(model.robot, poses, link_b, bounds.point_b))
                              .topRows<3>()
                              .transpose() *
                          constraint.normal;
    append(std::move(constraint));
  }
  return constraints;
}

}  // namespace clearway
