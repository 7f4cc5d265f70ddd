#include "planning/geometry/boxed.hpp"

#include <algorithm>
#include <array>

#include "planning/geometry/extents.hpp"

namespace clearway::boxed {
namespace {

/// Cell counts along the edges, at most most_cover_spheres in all, that keep the cells' diagonal small: the
/// longest cell edge is halved in turn.
std::array<int, 3> cell_counts(const Eigen::Vector3d& edges) {
  std::array<int, 3> counts{1, 1, 1};
  while (true) {
    int longest = 0;
    for (int i = 1; i < 3; ++i) {
      if (edges[i] / counts[static_cast<std::size_t>(i)] >
          edges[longest] / counts[static_cast<std::size_t>(longest)])
        longest = i;
    }
    std::array<int, 3> more = counts;
    ++more[static_cast<std::size_t>(longest)];
    if (static_cast<std::size_t>(more[0] * more[1] * more[2]) > most_cover_spheres) return counts;
    counts = more;
  }
}

}  // namespace

MedialSegment medial_segment(const Shape& shape) {
  MedialSegment segment;
  int longest = 0;
  segment.half_extent = shape.edges().maxCoeff(&longest) / 2;
  segment.width = shape.edges().minCoeff();
  segment.half_length = std::max(0.0, segment.half_extent - segment.width / 2);
  segment.axis = Eigen::Vector3d::Unit(longest);
  return segment;
}

double signed_distance(const Shape& shape, const Eigen::Vector3d& point) {
  return extents::distance(Eigen::Vector3d((point - shape.box_center()).cwiseAbs() - shape.edges() / 2));
}

lanes::Numbers signed_distances(const Shape& shape, const FourPoints& points) {
  const Eigen::Vector3d &center = shape.box_center(), half = shape.edges() / 2;
  const auto past = [&](const lanes::Numbers& along, int axis) {
    return lanes::absolute(along - lanes::all(center[axis])) - lanes::all(half[axis]);
  };
  const lanes::Numbers x = past(points.x, 0), y = past(points.y, 1), z = past(points.z, 2);
  const lanes::Numbers none = lanes::all(0.0), out_x = lanes::larger(x, none), out_y = lanes::larger(y, none),
                       out_z = lanes::larger(z, none);
  return lanes::root(out_x * out_x + out_y * out_y + out_z * out_z) +
         lanes::smaller(lanes::larger(lanes::larger(x, y), z), none);
}

Eigen::Vector3d offset_to(const Shape& shape, const Eigen::Vector3d& point) {
  const Eigen::Vector3d local = point - shape.box_center();
  return local - local.cwiseMax(-shape.edges() / 2).cwiseMin(shape.edges() / 2);
}

Cells cells(const Shape& shape) {
  const Eigen::Vector3d& edges = shape.edges();
  const std::array<int, 3> counts = cell_counts(edges);
  Cells cells{{edges.x() / counts[0], edges.y() / counts[1], edges.z() / counts[2]}, {}};
  for (int x = 0; x < counts[0]; ++x) {
    for (int y = 0; y < counts[1]; ++y) {
      for (int z = 0; z < counts[2]; ++z) {
        cells.centers.emplace_back(shape.box_center() - edges / 2 +
                                   cells.edges.cwiseProduct(Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5)));
      }
    }
  }
  return cells;
}

}  // namespace clearway::boxed
