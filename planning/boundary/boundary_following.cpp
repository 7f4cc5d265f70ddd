#include "planning/boundary/boundary_following.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace clearway {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// A vertex that advances less than this share of max_step along S is null.
constexpr double kNull = 0.01;

/// Component of `v` orthogonal to the unit vector `u`, normalised; zero when v is parallel to u.
VectorXd orthogonal_part(const VectorXd& v, const VectorXd& u) {
  VectorXd part = v - u.dot(v) * u;
  part -= u.dot(part) * u;  // once more for orthogonality in floating point
  const double length = part.norm();
  return length > 1e-9 * v.norm() ? VectorXd(part / length) : VectorXd(VectorXd::Zero(v.size()));
}

/// Follows `followed`, switching to the constraint that blocks whenever the vertex is null. Each constraint
/// is tried once.
BoundaryStep follow(const std::vector<ProjectedConstraint>& projected, int followed, double max_step) {
  BoundaryStep step;
  std::vector<bool> was_tried(projected.size(), false);
  const auto is_new = [&](int constraint) {
    return constraint >= 0 && !was_tried[static_cast<std::size_t>(constraint)];
  };
  while (is_new(followed)) {
    was_tried[static_cast<std::size_t>(followed)] = true;
    step.followed = followed;
    step.vertex = vertex_on(projected, followed, max_step);
    step.is_null = !step.vertex.exists || step.vertex.advance < kNull * max_step;
    if (!step.is_null) return step;
    const bool is_excluded = !step.vertex.exists && is_new(step.vertex.behind);
    followed = is_excluded ? step.vertex.behind : step.vertex.blocking;
    ++(is_excluded ? step.skipped : step.switches);
  }
  return step;
}

}  // namespace

BypassPlane bypass_plane(const VectorXd& lock, const VectorXd& goal, const VectorXd& limit) {
  BypassPlane plane;
  plane.lock = lock;
  plane.u1 = (goal - lock).normalized();               // Lahouar 2006, eq. 10
  plane.u2 = orthogonal_part(limit - lock, plane.u1);  // Lahouar 2006, eq. 11, 12
  for (Index j = 0; plane.u2.isZero(0.0) && j < lock.size(); ++j) {
    plane.u2 = orthogonal_part(VectorXd::Unit(lock.size(), j), plane.u1);
  }
  return plane;
}

Configuration side_limits(const Robot& robot, const Configuration& lock, bool upper) {
  Configuration limit = lock;
  for (Index j = 0; j < lock.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    const double value = upper ? joint.upper : joint.lower;
    limit[j] = std::isfinite(value) ? value : lock[j] + (upper ? std::numbers::pi : -std::numbers::pi);
  }
  return limit;
}

std::vector<ProjectedConstraint> project(const StepConstraints& constraints, const BypassPlane& plane,
                                         double max_step) {
  const Index n = plane.u1.size(), m = constraints.matrix.rows();
  std::vector<ProjectedConstraint> projected;
  const auto add = [&](const Vector2d& A, double bound, double size, Index source, bool is_pair) {
    const double length = A.norm();
    if (length <= 1e-9 * size || !std::isfinite(bound)) return;
    projected.push_back(
        {A / length, bound / length, static_cast<int>(source), is_pair || bound / length <= max_step});
  };
  for (Index i = 0; i < m; ++i) {
    const auto a = constraints.matrix.row(i);
    add({a.dot(plane.u1), a.dot(plane.u2)}, constraints.bounds[i], a.norm(), i,
        true);  // Lahouar 2006, eq. 14-20
  }
  for (Index j = 0; j < n; ++j) add({plane.u1[j], plane.u2[j]}, constraints.upper[j], 1.0, m + j, false);
  for (Index j = 0; j < n; ++j)
    add({-plane.u1[j], -plane.u2[j]}, -constraints.lower[j], 1.0, m + n + j, false);
  return projected;
}

int first_followed(const std::vector<ProjectedConstraint>& projected, const VectorXd& multipliers) {
  for (const bool only_active : {true, false}) {
    int best = -1;
    for (std::size_t i = 0; i < projected.size(); ++i) {
      const bool is_active = multipliers[projected[i].source] > 0.0;
      if (!projected[i].can_be_followed || (only_active && !is_active)) continue;
      if (best < 0 || projected[i].direction[0] > projected[static_cast<std::size_t>(best)].direction[0])
        best = static_cast<int>(i);
    }
    if (best >= 0) return best;
  }
  return -1;
}

int tracked(const std::vector<ProjectedConstraint>& projected, const Vector2d& last) {
  int best = -1;
  double best_product = 0.0;
  for (std::size_t i = 0; i < projected.size(); ++i) {
    if (!projected[i].can_be_followed) continue;
    const double product = projected[i].direction.dot(last);
    const bool is_equal = best >= 0 && std::abs(product - best_product) <= 1e-9;
    const bool is_nearer = best >= 0 && projected[i].bound < projected[static_cast<std::size_t>(best)].bound;
    if (best < 0 || (is_equal ? is_nearer : product > best_product)) {
      best = static_cast<int>(i);
      best_product = product;
    }
  }
  return best;
}

Vertex vertex_on(const std::vector<ProjectedConstraint>& projected, int followed, double max_step) {
  const ProjectedConstraint& line = projected[static_cast<std::size_t>(followed)];
  const Vector2d S(-line.direction[1], line.direction[0]);  // Lahouar 2006, eq. 22
  const double offset = std::min(line.bound, max_step * std::numbers::sqrt2 / 2.0);
  Vertex vertex;
  if (offset < -max_step) return vertex;  // the demanded separation is more than one step
  const Vector2d foot = offset * line.direction;
  double least = -std::sqrt(std::max(0.0, max_step * max_step - offset * offset)), most = -least;
  const double slack = 1e-12 * max_step;
  for (std::size_t i = 0; i < projected.size(); ++i) {
    if (static_cast<int>(i) == followed) continue;
    const double slope = projected[i].direction.dot(S),
                 room = projected[i].bound - projected[i].direction.dot(foot);
    if (std::abs(slope) <= 1e-12) {
      if (room < -slack) {  // parallel and nearer: it ends the way everywhere
        vertex.blocking = static_cast<int>(i);
        return vertex;
      }
    } else if (slope > 0.0 && room / slope < most) {
      most = room / slope;
      vertex.blocking = static_cast<int>(i);
    } else if (slope < 0.0 && room / slope > least) {
      least = room / slope;
      vertex.behind = static_cast<int>(i);
    }
  }
  vertex.exists = least <= most + slack;
  vertex.advance = most;
  vertex.du = foot + most * S;
  return vertex;
}

BoundaryStep boundary_step(std::vector<ProjectedConstraint> projected, int followed, double max_step) {
  BoundaryStep step = follow(projected, followed, max_step);
  if (!step.is_null) return step;
  for (ProjectedConstraint& constraint : projected) constraint.bound = std::max(constraint.bound, 0.0);
  BoundaryStep relaxed = follow(projected, followed, max_step);
  relaxed.relaxed = true;
  return relaxed;
}

}  // namespace clearway
