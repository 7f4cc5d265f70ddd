#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <memory>
#include <span>

#include "mapping/voxels/voxel_state.hpp"

namespace clearway {

/// How far the nearest blocked voxel cube is, and which way.
struct NearestBlocked {
  double distance = 0.0;                                ///< exact distance to the cube; 0 inside one
  Eigen::Vector3d point = Eigen::Vector3d::Zero();      ///< nearest point of the cube
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit, from the query to the cube; zero inside
  Eigen::Vector3d voxel = Eigen::Vector3d::Zero();      ///< centre of that voxel
  bool found = false;                                   ///< false: nothing within the search distance
};

/// Where a ray first meets blocked space.
struct RayHit {
  bool hit = false;
  Eigen::Vector3d voxel = Eigen::Vector3d::Zero();  ///< centre of the blocked voxel, or of the last one seen
  double distance = 0.0;                            ///< from the origin to that centre, metres
};

/// Coordinates of many points, an array an axis, all of one length; metres. Doubles, as whoever computes the
/// middle of a sphere has it: there is no rounding to float that one would have to add to the sphere's
/// radius.
struct PointArrays {
  std::span<const double> x, y, z;
};

struct ByteField;  // of the floors above: mapping/field/byte_field.hpp, which is not installed

/// The voxels that one requirement forbids, inside one region, ready for geometric queries.
/// Immutable and safe to read from many threads. Everything here is derived from the map's tree.
///
/// Outside the region: under `not_occupied` a voxel there counts as its tree says only if the region was
/// grown to hold it; the region is the part of the map that the caller asked for, and everything beyond it
/// counts as free under `not_occupied` and as blocked under `painted` and `known_free`.
class BlockedSpace {
 public:
  static constexpr double most_voxels = 89.0;  ///< how far a field may know distances

  virtual ~BlockedSpace() = default;

  virtual const Requirement& requirement() const = 0;
  virtual double resolution() const = 0;    ///< edge of a voxel cube, metres
  virtual double max_distance() const = 0;  ///< where the field ends, metres: as asked, at most 89 voxels
  virtual const Eigen::AlignedBox3d& region() const = 0;
  virtual std::size_t blocked_count() const = 0;  ///< blocked voxels inside the region

  /// Computes at once what queries looked at in earlier versions of the map and later ones changed. Else it
  /// is computed when it is looked at again. For whoever must not wait then; answers are the same.
  virtual void renew() const = 0;

  virtual bool is_blocked(const Eigen::Vector3d& point) const = 0;
  /// The same of a whole voxel, floor(point / resolution).
  virtual bool is_voxel_blocked(const Eigen::Vector3i& voxel) const = 0;

  /// Conservative lower bound of the distance from `point` to the nearest blocked voxel cube, never larger
  /// than the true distance; 0 inside a blocked voxel and for a non-finite point; at most max_distance().
  virtual double clearance(const Eigen::Vector3d& point) const = 0;

  /// The same from one cell alone, the one that holds the point: never larger than clearance(), and smaller
  /// than the distance by up to a voxel's diagonal (1.74 voxels), a third of a voxel on average. For
  /// accepting at once what is far from everything; it costs a third of clearance().
  virtual double coarse_clearance(const Eigen::Vector3d& point) const = 0;

  /// clearance() and coarse_clearance() of many points, bit for bit the same in less than half the time:
  /// out[i] is that of point i. They need not be near each other.
  /// @throws std::invalid_argument when the arrays and `out` differ in length.
  virtual void clearances(const PointArrays& points, std::span<double> out) const = 0;
  virtual void coarse_clearances(const PointArrays& points, std::span<double> out) const = 0;

  /// The field once more, for look-ups of many points at single precision. Made at the first call, from any
  /// thread; lives as long as this object.
  virtual const ByteField& byte_field() const = 0;

  /// The squared distance from the middle of a voxel to the nearest blocked cube, in half voxels: exact, a
  /// whole number, 0 in a blocked voxel; beyond max_distance() some number that is no smaller than it. After
  /// the voxel's own come those of the six that share a face with it, before and behind it along x, y and z.
  /// -1 for a voxel that lies outside the region where that counts as free.
  /// @param voxel floor(point / resolution)
  virtual std::array<int, 7> squared_around(const Eigen::Vector3i& voxel) const = 0;

  /// The exact nearest blocked cube no farther than `limit` (taken as at most max_distance()).
  /// @throws std::invalid_argument for a non-finite point or a limit that is not >= 0.
  virtual NearestBlocked nearest(const Eigen::Vector3d& point, double limit) const = 0;

  /// The first blocked voxel that a ray enters, its own included: the voxel that OctoMap's castRay stops at
  /// (`not_occupied`: with unknown ignored; `known_free`: without). Origin and direction are rounded to
  /// float, as there.
  /// @param max_range to the voxel's centre, metres; 0: as far as the region goes.
  /// @throws std::invalid_argument for a ray that is not finite, has no direction or one longer than 1e19, or
  ///         starts more than 2^28 voxels off, or a negative range.
  virtual RayHit cast_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                          double max_range) const = 0;

  /// Calls `visit(centre)` for each blocked voxel whose closed cube meets the closed `box`, in a fixed order,
  /// until it returns false. Returns false when it was stopped. (Blocked space beyond the region, where the
  /// requirement blocks it, is visited as voxels too.)
  virtual bool visit_blocked(const Eigen::AlignedBox3d& box,
                             const std::function<bool(const Eigen::Vector3d&)>& visit) const = 0;

  /// The same for the surface alone: blocked voxels that share a face with one that is not blocked. Who comes
  /// from space that is not blocked meets one of them first.
  virtual bool visit_surface(const Eigen::AlignedBox3d& box,
                             const std::function<bool(const Eigen::Vector3d&)>& visit) const = 0;
};

}  // namespace clearway
