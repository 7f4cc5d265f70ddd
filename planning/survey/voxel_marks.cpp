#include "planning/survey/voxel_marks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "planning/geometry/convex_hull.hpp"

namespace clearway {
namespace {

constexpr double half_diagonal = 0.8660254037844387;  ///< of a cube of edge 1, rounded up
constexpr double most_cells_away = 1e15;  ///< from the origin: beyond, doubles distinguish no cells

/// Bits of a brick lie in Morton order: 64 in a row are a cube of 4 x 4 x 4 voxels, 8 one of 2 x 2 x 2.
bool is_full(const VoxelMarks::Brick& brick, int first, int count) {
  if (count >= 64) {
    for (int word = first / 64; word < (first + count) / 64; ++word)
      if (brick[static_cast<std::size_t>(word)] != ~std::uint64_t{0}) return false;
    return true;
  }
  const std::uint64_t mask = ((std::uint64_t{1} << count) - 1) << (first % 64);
  return (brick[static_cast<std::size_t>(first / 64)] & mask) == mask;
}

void fill(VoxelMarks::Brick& brick, int first, int count) {
  if (count >= 64) {
    for (int word = first / 64; word < (first + count) / 64; ++word)
      brick[static_cast<std::size_t>(word)] = ~std::uint64_t{0};
    return;
  }
  brick[static_cast<std::size_t>(first / 64)] |= ((std::uint64_t{1} << count) - 1) << (first % 64);
}

std::size_t marked(const VoxelMarks::Brick& brick) {
  std::size_t count = 0;
  for (const std::uint64_t word : brick) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

/// Cell of a Morton index within its brick.
Cell cell_of(int index) {
  Cell cell = Cell::Zero();
  for (int level = 0; level < 3; ++level) {
    for (int axis = 0; axis < 3; ++axis) cell[axis] |= ((index >> (3 * level + axis)) & 1) << level;
  }
  return cell;
}

}  // namespace

MarkedShape::MarkedShape(const Shape& shape) : shape_(shape) {
  if (shape.has_exact_distance()) return;
  const std::vector<Eigen::Vector3d>& corners = shape.vertices();
  for (const auto& [a, b, c] : hull_triangles(corners)) {
    const Eigen::Vector3d& at = corners[static_cast<std::size_t>(a)];
    const Eigen::Vector3d normal =
        (corners[static_cast<std::size_t>(b)] - at).cross(corners[static_cast<std::size_t>(c)] - at);
    if (normal.norm() == 0.0) continue;
    const Eigen::Vector3d unit = normal.normalized();
    double farthest = unit.dot(at);  // rounding left no corner outside
    for (const Eigen::Vector3d& corner : corners) farthest = std::max(farthest, unit.dot(corner));
    planes_.emplace_back(unit.x(), unit.y(), unit.z(), farthest);
  }
}

double MarkedShape::distance(const Eigen::Vector3d& point) const {
  if (shape_.has_exact_distance()) return shape_.signed_distance(point);
  double most = -1e300;
  for (const Eigen::Vector4d& plane : planes_) most = std::max(most, plane.head<3>().dot(point) - plane.w());
  // A flat hull has no faces, and no inside.
  return planes_.empty() ? std::max(shape_.signed_distance(point), 0.0) : most;
}

bool MarkedShape::touches(const Eigen::Isometry3d& pose, const Eigen::Vector3d& center, double edge) const {
  const double half = edge / 2;
  if (shape_.has_exact_distance()) {
    // From the shape's point that is nearest to the cube's middle: it lies in the cube, or the plane through
    // it has the shape on one side and the cube on the other; else nothing is known.
    const Eigen::Vector3d local = pose.linear().transpose() * (center - pose.translation());
    const Eigen::Vector3d offset = pose.linear() * shape_.offset_to(local);
    if (offset.cwiseAbs().maxCoeff() <= half) return true;
    if (offset.squaredNorm() > half * offset.cwiseAbs().sum() * (1.0 + 1e-9)) return false;
  }
  return distance_to_cube(shape_, pose, center, edge, 0.0).lower <= 0.0;
}

struct VoxelMarks::Body {
  const MarkedShape& shape;
  const Eigen::Isometry3d& map_from_shape;
  Eigen::Isometry3d shape_from_map;
};

bool VoxelMarks::mark(const MarkedShape& shape, const Eigen::Isometry3d& map_from_shape) {
  const Eigen::AlignedBox3d box = shape.shape().bounds(map_from_shape);
  const double brick = brick_edge * edge_;
  const Eigen::Array3d low = (box.min().array() / brick - 1e-9).floor();
  const Eigen::Array3d high = (box.max().array() / brick + 1e-9).floor();
  const bool is_near = low.abs().maxCoeff() < most_cells_away && high.abs().maxCoeff() < most_cells_away;
  const double bricks = (high - low + 1.0).prod();
  if (!is_near || bricks > most_bricks_ || (looks_ += bricks) > most_looks_) return false;
  const Body body{shape, map_from_shape, map_from_shape.inverse()};
  const Cell first = low.cast<std::int64_t>().matrix(), last = high.cast<std::int64_t>().matrix();
  for (std::int64_t z = first.z(); z <= last.z(); ++z) {
    for (std::int64_t y = first.y(); y <= last.y(); ++y) {
      for (std::int64_t x = first.x(); x <= last.x(); ++x) {
        const Cell at(x, y, z);
        const Eigen::Vector3d corner = at.cast<double>() * brick;
        const Eigen::Vector3d middle = corner.array() + brick / 2;
        if (shape.distance(body.shape_from_map * middle) > half_diagonal * brick * (1.0 + 1e-9)) continue;
        const auto known = bricks_.find(at);
        Brick marks = known != bricks_.end() ? known->second : Brick{};
        mark_cube(body, corner, brick_edge, 0, marks);
        if (known != bricks_.end()) {
          known->second = marks;
        } else if (marked(marks) > 0) {
          if (static_cast<double>(bricks_.size()) >= most_bricks_) return false;
          bricks_.emplace(at, marks);
        }
      }
    }
  }
  return true;
}

/// @param corner the smallest, map frame @param cells along the cube's edge @param first its first bit
void VoxelMarks::mark_cube(const Body& body, const Eigen::Vector3d& corner, int cells, int first,
                           Brick& brick) const {
  const int count = cells * cells * cells;
  if (is_full(brick, first, count)) return;
  const double size = cells * edge_;
  const Eigen::Vector3d middle = corner.array() + size / 2;
  const double distance = body.shape.distance(body.shape_from_map * middle);
  const double reach = half_diagonal * size * (1.0 + 1e-9);
  if (distance > reach) return;
  if (distance <= -reach) return fill(brick, first, count);
  if (cells == 1) {
    if (distance < 0.0 || body.shape.touches(body.map_from_shape, middle, edge_)) fill(brick, first, 1);
    return;
  }
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d step(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    mark_cube(body, corner + step * (size / 2), cells / 2, first + i * count / 8, brick);
  }
}

std::size_t VoxelMarks::count() const {
  std::size_t total = 0;
  for (const auto& [at, brick] : bricks_) total += marked(brick);
  return total;
}

void VoxelMarks::visit(const std::function<bool(const Cell&, std::size_t)>& visit,
                       const std::function<void(const Cell&)>& visit_voxel) const {
  for (const auto& [at, brick] : bricks_) {
    const Cell first = at * brick_edge;
    if (!visit(first, marked(brick))) continue;
    for (int i = 0; i < 512; ++i) {
      if ((brick[static_cast<std::size_t>(i / 64)] >> (i % 64)) & 1U) visit_voxel(first + cell_of(i));
    }
  }
}

std::size_t VoxelMarks::CellHash::operator()(const Cell& cell) const {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis)
    hash = (hash ^ static_cast<std::uint64_t>(cell[axis])) * 0x9e3779b97f4a7c15ULL;
  return static_cast<std::size_t>(hash ^ (hash >> 29));
}

}  // namespace clearway
