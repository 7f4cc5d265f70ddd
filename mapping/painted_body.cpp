// Bodies in the painted voxels: the field along the axis, the exact body against cubes where that says
// nothing.

#include "mapping/painted_body.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/body_cube.hpp"

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
  Eigen::Vector3d axis;  ///< unit; zero for a ball
  double length = 0.0;
  double radius = 0.0;
  bool flat = false;

  Rod(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double r, bool flat_ends)
      : start(a), axis(Eigen::Vector3d::Zero()), length((b - a).norm()), radius(r), flat(flat_ends) {
    if (length > 0.0) axis = (b - a) / length;
  }
  Eigen::Vector3d at(double along) const { return start + along * axis; }
  /// How far along the axis, to either side of a point, a ball of `clearance` about it holds the rod.
  double reach(double clearance) const {
    if (clearance <= radius) return 0.0;
    return flat ? std::sqrt(clearance * clearance - radius * radius) : clearance - radius;
  }
};

PaintedSpace::PaintedSpace(const Snapshot& map, std::uint16_t volumes) {
  Eigen::AlignedBox3d box;
  map.visit_leaves([&](const Voxel& leaf) {
    if ((leaf.volumes & volumes) == 0) return;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(leaf.size / 2);
    box.extend(leaf.center - half);
    box.extend(leaf.center + half);
  });
  if (box.isEmpty()) return;
  // Half a voxel in: rounding must not add a layer of cells.
  box.min().array() += 0.5 * map.resolution();
  box.max().array() -= 0.5 * map.resolution();
  space_ = map.blocked_space({Policy::painted, volumes}, box, 89.0 * map.resolution());
}

bool PaintedSpace::contains(const Sphere& ball) const {
  return contains(Capsule{ball.center, ball.center, ball.radius});
}

bool PaintedSpace::contains(const Capsule& capsule) const {
  check(capsule.a, capsule.b, capsule.radius);
  return holds(Rod(capsule.a, capsule.b, capsule.radius, false));
}

bool PaintedSpace::contains(const Cylinder& cylinder) const {
  check(cylinder.a, cylinder.b, cylinder.radius);
  return holds(Rod(cylinder.a, cylinder.b, cylinder.radius, cylinder.a != cylinder.b));
}

/// Steps along the axis as far as the field allows; where it does not, pieces of some voxels are checked
/// against the cubes. The pieces together are the rod.
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
  struct Piece {
    Eigen::Vector3d a, b;
    double radius, half;
    bool flat;
  } const piece{rod.at(from), rod.at(to), rod.radius + slack * space_->resolution(),
                0.5 * space_->resolution(), rod.flat};
  Eigen::AlignedBox3d bounds(piece.a);
  bounds.extend(piece.b);
  bounds.min().array() -= piece.radius;
  bounds.max().array() += piece.radius;
  return space_->visit_blocked(bounds, [&piece](const Eigen::Vector3d& center) {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(piece.half);
    const Eigen::AlignedBox3d cube(center - half, center + half);
    if (segment_box_squared(piece.a, piece.b, cube) > piece.radius * piece.radius) return true;
    return piece.flat && piece.a != piece.b &&
           axis_distance_between_ends({piece.a, piece.b, piece.radius}, cube) > piece.radius;
  });
}

}  // namespace clearway
