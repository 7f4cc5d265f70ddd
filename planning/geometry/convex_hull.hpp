#pragma once

#include <Eigen/Core>
#include <array>
#include <mutex>
#include <vector>

#include "mapping/voxels/sphere.hpp"
#include "planning/geometry/shape_surface.hpp"

namespace clearway {

/// The corners of the convex hull of `points`, in their order, doubles removed. Fewer corners only make
/// support queries faster: for points that qhull cannot handle (flat, fewer than five) all of them are kept.
std::vector<Eigen::Vector3d> hull_corners(std::vector<Eigen::Vector3d> points);

/// The surface of the hull as triangles of `points`' indices, counter-clockwise seen from outside; empty for
/// points that span no volume. For drawing; collision queries need the corners only.
std::vector<std::array<int, 3>> hull_triangles(const std::vector<Eigen::Vector3d>& points);

/// These triangles of one hull, found when they are first asked for. Safe from many threads.
class HullTriangles {
 public:
  /// @param corners the same each time
  const std::vector<std::array<int, 3>>& of(const std::vector<Eigen::Vector3d>& corners) const;

 private:
  mutable std::once_flag found_;
  mutable std::vector<std::array<int, 3>> triangles_;
};

/// The edges of a closed surface as pairs of indices, the lower one first.
std::vector<std::array<int, 2>> surface_edges(const ShapeSurface& surface);

/// Spheres that together hold a hull with this surface, at most so many (at least one): around parts of it,
/// of which the one whose sphere stands out most is halved in turn. A half's sphere may stand out more than
/// that of the whole: of all these covers it is the one that stands out least. Empty where HullPlanes knows
/// nothing.
std::vector<Sphere> hull_cover(const ShapeSurface& hull, std::size_t most);

/// The corners of what lies `by` (> 0) and more behind each face of the hull of `points`; none where that
/// does not hold `middle`, or where the points span no volume.
std::vector<Eigen::Vector3d> corners_behind_faces(const std::vector<Eigen::Vector3d>& points,
                                                  const Eigen::Vector3d& middle, double by);

/// The planes of the hull's faces, for spheres inside it.
class HullPlanes {
 public:
  /// Knows nothing of a surface that does not close, or has no triangles.
  explicit HullPlanes(const ShapeSurface& hull);

  /// True when no point is farther outside of the planes than a millionth of the hull's size.
  bool is_known() const { return !normals_.empty(); }

  /// A sphere of this radius about the point lies in the hull; <= 0: none is known. It falls short of the
  /// largest by a millionth of the hull's size.
  double inner_radius(const Eigen::Vector3d& point) const;

 private:
  std::vector<Eigen::Vector3d> normals_;  ///< outwards
  std::vector<double> offsets_;           ///< normal * x <= offset inside
};

}  // namespace clearway
