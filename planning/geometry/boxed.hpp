#pragma once

// Not part of the installed library.

#include "planning/geometry/four_points.hpp"
#include "planning/geometry/shape.hpp"

/// What boxes and hulls share: answers from the box around them, of edges() about box_center().
namespace clearway::boxed {

MedialSegment medial_segment(const Shape& shape);
double signed_distance(const Shape& shape, const Eigen::Vector3d& point);
lanes::Numbers signed_distances(const Shape& shape, const FourPoints& points);
Eigen::Vector3d offset_to(const Shape& shape, const Eigen::Vector3d& point);

/// The box in equal cells, nearly cubes, at most `most_cover_spheres`.
struct Cells {
  Eigen::Vector3d edges;                 ///< of a cell
  std::vector<Eigen::Vector3d> centers;  ///< x slowest, z fastest
};
Cells cells(const Shape& shape);

/// The sphere around a cell.
inline Sphere around_cell(const Cells& cells, const Eigen::Vector3d& center) {
  return {center, cells.edges.norm() / 2};
}

}  // namespace clearway::boxed
