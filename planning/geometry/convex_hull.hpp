#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// The corners of the convex hull of `points`, in their order, doubles removed. Fewer corners only make
/// support queries faster: for points that qhull cannot handle (flat, fewer than five) all of them are kept.
std::vector<Eigen::Vector3d> hull_corners(std::vector<Eigen::Vector3d> points);

/// The surface of the hull as triangles of `points`' indices, counter-clockwise seen from outside; empty for
/// points that span no volume. For drawing; collision queries need the corners only.
std::vector<std::array<int, 3>> hull_triangles(const std::vector<Eigen::Vector3d>& points);

/// The edges of that surface as pairs of indices; empty, too, where it is not closed.
std::vector<std::array<int, 2>> hull_edges(const std::vector<Eigen::Vector3d>& points);

/// Spheres that together hold the hull of `points`, at most so many (at least one): around parts of it, of
/// which the one whose sphere stands out most is halved in turn. A half's sphere may stand out more than that
/// of the whole: of all these covers it is the one that stands out least. Empty where HullPlanes knows
/// nothing.
std::vector<Sphere> hull_cover(const std::vector<Eigen::Vector3d>& points, std::size_t most);

/// The corners of what lies `by` (> 0) and more behind each face of the hull of `points`; none where that
/// does not hold `middle`, or where the points span no volume.
std::vector<Eigen::Vector3d> corners_behind_faces(const std::vector<Eigen::Vector3d>& points,
                                                  const Eigen::Vector3d& middle, double by);

/// The planes of the hull's faces, for spheres inside it.
class HullPlanes {
 public:
  /// Knows nothing where the points span no volume or qhull's faces do not close.
  explicit HullPlanes(const std::vector<Eigen::Vector3d>& points);

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
