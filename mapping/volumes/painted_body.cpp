// Bodies in the painted voxels: the field along the axis, the exact body against cubes where that says
// nothing.

#include "mapping/volumes/painted_body.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/volumes/body_cube.hpp"

namespace clearway {
namespace {

/// Closed against closed, and what is within rounding of touching touches.
constexpr double slack = 1e-9;

void check(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  if (a.allFinite() && b.allFinite() && std::isfinite(radius) && radius > 0.0) return;
  throw std::invalid_argument("body in a painted volume: expected finite ends and a radius > 0 in metres");
}

}  // namespace

/// A capsule, or a cylinder when `flat`.
struct PaintedSpace::Rod {
  Eigen::Vector3d start;
  Eigen::Vector3d axis;  ///< unit; zero for a sphere
  double length = 0.0;
  double radius = 0.0;
  bool flat = false;

  Rod(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double r, bool flat_ends)
      : start(a), axis(Eigen::Vector3d::Zero()), length((b - a).norm()), radius(r), flat(flat_ends) {
    if (length > 0.0) axis = (b - a) / length;
  }
  Eigen::Vector3d at(double along) const { return start + along * axis; }
  /// True when a point within `radius` of the axis lies in the rod.
  bool is_between_ends(const Eigen::Vector3d& point) const {
    const double along = (point - start).dot(axis);
    return !flat || (along >= 0.0 && along <= length);
  }
  /// How far along the axis, to either side of a point, a sphere of `clearance` about it holds the rod.
  double reach(double clearance) const {
    if (clearance <= radius) return 0.0;
    return flat ? std::sqrt(clearance * clearance - radius * radius) : clearance - radius;
  }
};

PaintedSpace::PaintedSpace(const Snapshot& map, std::uint16_t volumes) {
  Eigen::AlignedBox3d box;
  map.visit_leaves([&](const Voxel& leaf) {
    if ((leaf.volumes & volumes) == 0) return;
    // To the middles of its outermost voxels: rounding must neither add a layer of cells nor take one away.
    const Eigen::Vector3d half = Eigen::Vector3d::Constant((leaf.size - map.resolution()) / 2);
    box.extend(leaf.center - half);
    box.extend(leaf.center + half);
  });
  if (box.isEmpty()) return;
  space_ = map.blocked_space({Policy::painted, volumes}, box, 89.0 * map.resolution());
}

bool PaintedSpace::contains(const Sphere& sphere) const {
  return contains(Capsule{sphere.center, sphere.center, sphere.radius});
}

bool PaintedSpace::contains(const Capsule& capsule) const {
  check(capsule.a, capsule.b, capsule.radius);
  return holds(Rod(capsule.a, capsule.b, capsule.radius, false));
}

bool PaintedSpace::contains(const Cylinder& cylinder) const {
  check(cylinder.a, cylinder.b, cylinder.radius);
  return holds(Rod(cylinder.a, cylinder.b, cylinder.radius, cylinder.a != cylinder.b));
}

/// Steps along the axis as far as the field allows; where it does not, the nearest cube may refuse the rod,
/// else a piece of some voxels is checked against all cubes near. The pieces together are the rod.
bool PaintedSpace::holds(const Rod& rod) const {
  if (space_ == nullptr) return false;
  if (space_->is_blocked(rod.at(0.0)) || space_->is_blocked(rod.at(rod.length))) return false;
  const double voxel = space_->resolution();
  double done = 0.0;
  bool at_end = false;
  while (!at_end) {
    const Eigen::Vector3d point = rod.at(done);
    if (space_->is_blocked(point)) return false;
    double next = done + rod.reach(space_->clearance(point));
    if (next < done + 0.5 * voxel && next < rod.length + slack * voxel) {
      const NearestBlocked near = space_->nearest(point, rod.radius);
      if (near.found && rod.is_between_ends(near.point)) return false;
      next = done + 4.0 * voxel;
      if (!holds_piece(rod, done, std::min(next, rod.length))) return false;
    }
    at_end = next >= rod.length;
    done = next;
  }
  return true;
}

/// True when no blocked cube meets the piece of the rod from `from` to `to` along its axis.
bool PaintedSpace::holds_piece(const Rod& rod, double from, double to) const {
  const double voxel = space_->resolution();
  struct Piece {
    Eigen::Vector3d a, along;
    double length, radius, half;
    bool flat;

    /// From the axis to a point, squared.
    double off_axis(const Eigen::Vector3d& p) const {
      return (a + std::clamp((p - a).dot(along), 0.0, length) * along - p).squaredNorm();
    }
  } const piece{rod.at(from), rod.axis, to - from, rod.radius + slack * voxel, 0.5 * voxel, rod.flat};
  const Eigen::Vector3d end = rod.at(to);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(piece.radius);
  const Eigen::AlignedBox3d bounds(piece.a.cwiseMin(end) - reach, piece.a.cwiseMax(end) + reach);
  return space_->visit_blocked(bounds, [&piece, &end](const Eigen::Vector3d& center) {
    const double far = piece.radius + 1.7320508076 * piece.half;  // from where a cube's centre is clear
    if (piece.off_axis(center) > far * far) return true;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(piece.half);
    const Eigen::AlignedBox3d cube(center - half, center + half);
    if (segment_box_squared(piece.a, end, cube) > piece.radius * piece.radius) return true;
    return piece.flat && piece.length > 0.0 &&
           axis_distance_between_ends({piece.a, end, piece.radius}, cube) > piece.radius;
  });
}

}  // namespace clearway
