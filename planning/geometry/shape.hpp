#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "mapping/voxels/sphere.hpp"
#include "planning/geometry/shape_surface.hpp"

namespace clearway {

class HullTriangles;
class ShapeKind;

constexpr std::size_t most_cover_spheres = 64;  ///< in the cover of one shape

/// A kind of shape that numbers describe: its name in files and how many numbers.
struct ShapeSizes {
  const char* name = "";
  int count = 0;
};

/// The segment in the middle of a shape along its longest direction: the rest is round or narrow.
struct MedialSegment {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit, shape's frame
  double half_length = 0.0;                         ///< of the segment, metres
  double half_extent = 0.0;                         ///< of the shape along the axis
  double width = 0.0;                               ///< of the shape, least across the axis
};

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

  /// The kinds that of_sizes() makes: all but `convex`, whose vertices describe it.
  static std::vector<ShapeSizes> sized_kinds();

  /// A shape as files describe it: `name` and `sizes` as name() and sizes() give them.
  /// @throws std::invalid_argument when no kind has that name and as many sizes, or one is not a size.
  static Shape of_sizes(std::string_view name, std::span<const double> sizes);

  Kind kind() const;
  std::string_view name() const;                           ///< of the kind: as the enumerator
  std::vector<double> sizes() const;                       ///< what its factory takes; convex: none
  double radius() const { return radius_; }                ///< sphere, capsule, cylinder; else 0
  double length() const { return length_; }                ///< capsule, cylinder; else 0
  const Eigen::Vector3d& edges() const { return edges_; }  ///< box; convex: of the box around it
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }  ///< convex: hull corners
  const Eigen::Vector3d& box_center() const { return box_center_; }  ///< convex: of the box around it

  /// True for a solid of revolution about the own z axis: sphere, capsule, cylinder.
  bool is_axial() const;

  /// True for all that lies within radius() of a segment, or point, on the own z axis: sphere, capsule.
  bool is_rounded() const;

  /// True when signed_distance() and offset_to() are exact: for all but `convex`.
  bool has_exact_distance() const;

  /// True when the shape is the box of edges() itself: `box`.
  bool fills_its_box() const;

  /// Farthest point of the shape along `direction` (need not be unit), in the shape's frame.
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const;

  /// Axis-aligned box of the shape placed at `pose`.
  Eigen::AlignedBox3d bounds(const Eigen::Isometry3d& pose) const;

  /// Radius of the smallest origin-centred sphere that holds the shape.
  double bounding_radius() const;

  /// A sphere that holds the shape, about the middle of the box around it; shape's frame.
  Sphere bounding_sphere() const;

  MedialSegment medial_segment() const;

  /// Spheres in the shape's frame whose union contains the shape; exact for spheres, tighter for more
  /// spheres.
  std::vector<Sphere> sphere_cover() const;

  Shape scaled(double factor) const;

  /// A shape that holds all within `padding` (metres, >= 0) of this one: just these for sphere and capsule;
  /// with edges that stay sharp else.
  Shape grown(double padding) const;

  /// What lies `depth` (metres, >= 0) and more inside of this one, of which a quarter of its least width
  /// stays at least; of a hull what lies so far behind each of its faces.
  Shape core(double depth) const;

  /// Distance of a point (shape's frame) from the surface, negative inside. Where it is not exact it is that
  /// of the bounding box: a lower bound.
  double signed_distance(const Eigen::Vector3d& point) const;

  /// From the nearest point of the shape (where that is not exact: of the box around it) to a point outside,
  /// in the shape's frame; zero for a point inside.
  Eigen::Vector3d offset_to(const Eigen::Vector3d& point) const;

  /// The surface as triangles, in the shape's frame. What is round has 24 sides, with corners on the surface.
  /// No triangles for a convex body that spans no volume.
  ShapeSurface surface() const;

  // Not part of the installed library.
  const ShapeKind& kind_functions() const { return *kind_; }
  const HullTriangles& hull_triangles() const { return *hull_triangles_; }  ///< @pre convex

 private:
  explicit Shape(const ShapeKind& kind) : kind_(&kind) {}

  const ShapeKind* kind_;
  double radius_ = 0.0, length_ = 0.0;
  Eigen::Vector3d edges_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> vertices_;
  std::shared_ptr<const HullTriangles> hull_triangles_;   ///< convex: of the vertices, shared by copies
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
