#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// An exact convex body: a core (point, segment, or convex hull) inflated by `radius()`.
/// Its own frame: centred at the origin; capsule and cylinder along z.
class Shape {
 public:
  enum class Kind { sphere, capsule, cylinder, box, convex };

  /// @throws std::invalid_argument naming the size that is not finite or not positive.
  static Shape sphere(double radius);
  static Shape capsule(double radius, double length);   ///< `length` between the centres of the caps
  static Shape cylinder(double radius, double length);  ///< flat ends
  static Shape box(const Eigen::Vector3d& edges);
  static Shape convex(std::vector<Eigen::Vector3d> vertices);  ///< hull of the points (at least one)

  Kind kind() const { return kind_; }
  double radius() const { return radius_; }                ///< sphere, capsule, cylinder
  double length() const { return length_; }                ///< capsule, cylinder
  const Eigen::Vector3d& edges() const { return edges_; }  ///< box; convex: of the box around it
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }  ///< convex: hull corners

  /// Farthest point of the shape along `direction` (need not be unit), in the shape's frame.
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const;

  /// Axis-aligned box of the shape placed at `pose`.
  Eigen::AlignedBox3d bounds(const Eigen::Isometry3d& pose) const;

  /// Radius of the smallest origin-centred sphere that holds the shape.
  double bounding_radius() const;

  /// Spheres in the shape's frame whose union contains the shape; exact for spheres, tighter for more
  /// spheres.
  std::vector<Sphere> sphere_cover() const;

  Shape scaled(double factor) const;

  /// Distance of a point (shape's frame) from the surface, negative inside. Exact for all kinds but `convex`,
  /// where it is that of the bounding box: a lower bound.
  double signed_distance(const Eigen::Vector3d& point) const;

  /// From the nearest point of the shape (for `convex`: of the box around it) to a point outside, in the
  /// shape's frame; zero for a point inside.
  Eigen::Vector3d offset_to(const Eigen::Vector3d& point) const;

 private:
  Kind kind_ = Kind::sphere;
  double radius_ = 0.0, length_ = 0.0;
  Eigen::Vector3d edges_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> vertices_;
  Eigen::Vector3d box_center_ = Eigen::Vector3d::Zero();  ///< convex: of the box around the vertices
};

/// Bounds on the distance between two convex bodies. `lower` is certified by a separating plane and never
/// larger than the true distance; `upper` is the distance between two points of the bodies.
struct DistanceBounds {
  double lower = 0.0;                                   ///< 0 when not proved separate
  double upper = 0.0;                                   ///< 0 when they (may) overlap
  Eigen::Vector3d point_a = Eigen::Vector3d::Zero();    ///< near point on a
  Eigen::Vector3d point_b = Eigen::Vector3d::Zero();    ///< near point on b
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit, from a to b
};

/// Distance between two shapes; both in the same frame. Gilbert-Johnson-Keerthi with a support-plane
/// certificate. Stops early once `lower > enough`.
DistanceBounds distance(const Shape& a, const Eigen::Isometry3d& pose_a, const Shape& b,
                        const Eigen::Isometry3d& pose_b, double enough = 1e9);

/// The same against an axis-aligned cube (a voxel).
DistanceBounds distance_to_cube(const Shape& a, const Eigen::Isometry3d& pose_a,
                                const Eigen::Vector3d& cube_center, double cube_edge, double enough = 1e9);

/// The cube against the convex hull of the body at two poses.
DistanceBounds swept_distance_to_cube(const Shape& a, const Eigen::Isometry3d& begin,
                                      const Eigen::Isometry3d& end, const Eigen::Vector3d& cube_center,
                                      double cube_edge, double enough = 1e9);

}  // namespace clearway
