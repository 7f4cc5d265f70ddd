#include "planning/survey/voxel_marks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "planning/geometry/farthest_vertex.hpp"
#include "planning/geometry/shape_kind.hpp"

namespace clearway {
namespace {

constexpr double half_diagonal = 0.8660254037844387;  ///< of a cube of edge 1, rounded up
constexpr int brick_bits = VoxelMarks::brick_edge * VoxelMarks::brick_edge * VoxelMarks::brick_edge;
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
  const auto& [corners, triangles] = shape.surface();
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3d& at = corners[static_cast<std::size_t>(a)];
    const Eigen::Vector3d normal =
        (corners[static_cast<std::size_t>(b)] - at).cross(corners[static_cast<std::size_t>(c)] - at);
    if (normal.norm() == 0.0) continue;
    const Eigen::Vector3d unit = normal.normalized();
    const double farthest =
        unit.dot(corners[farthest_vertex(corners, unit)]);  // rounding left no corner outside
    planes_.emplace_back(unit.x(), unit.y(), unit.z(), farthest);
  }
}

lanes::Numbers MarkedShape::distances(const FourPoints& points, double enough) const {
  if (shape_.has_exact_distance()) return shape_.kind_functions().signed_distances(shape_, points);
  // A flat hull has no faces, and no inside.
  if (planes_.empty())
    return lanes::larger(shape_.kind_functions().signed_distances(shape_, points), lanes::all(0.0));
  lanes::Numbers most = lanes::all(-1e300);
  for (const Eigen::Vector4d& plane : planes_) {
    most = lanes::larger(
        most, plane.x() * points.x + plane.y() * points.y + plane.z() * points.z - lanes::all(plane.w()));
    if (!lanes::any(most <= lanes::all(enough))) break;
  }
  return most;
}

bool MarkedShape::touches(const Eigen::Isometry3d& pose, const Eigen::Vector3d& center, double edge) const {
  if (shape_.has_exact_distance()) {
    // Nearest points of the two in turn, from the cube's middle on. The shape's lies in the cube, or the
    // plane through it has the shape on one side and the cube on the other, or the cube's corner that is
    // deepest beyond that plane lies in the shape; else nothing is known yet.
    constexpr int turns = 4;
    const double half = edge / 2;
    const Eigen::Matrix3d turned = pose.linear();
    const auto local = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
      return turned.transpose() * (point - pose.translation());
    };
    Eigen::Vector3d in_cube = center;
    for (int turn = 0; turn < turns; ++turn) {
      const Eigen::Vector3d offset = turned * shape_.offset_to(local(in_cube));
      const Eigen::Vector3d from_center = in_cube - offset - center;
      if (from_center.cwiseAbs().maxCoeff() <= half) return true;
      if (-offset.dot(from_center) > half * offset.cwiseAbs().sum() * (1.0 + 1e-9)) return false;
      if (shape_.signed_distance(local(center - half * offset.cwiseSign())) <= 0.0) return true;
      in_cube = center + from_center.cwiseMax(-half).cwiseMin(half);
    }
  }
  return distance_to_cube(shape_, pose, center, edge, 0.0).lower <= 0.0;
}

struct VoxelMarks::Body {
  const MarkedShape& shape;
  const Eigen::Isometry3d& map_from_shape;
  Eigen::Matrix3d rotation;     ///< shape from map
  Eigen::Vector3d translation;  ///< shape from map
  FourPoints lower, upper;      ///< the corners of the cube [-1, 1]^3 in Morton order, turned by `rotation`
  double surely;                ///< a surface that is nearer to a voxel's middle passes through the voxel

  Body(const MarkedShape& shape, const Eigen::Isometry3d& pose, double edge)
      : shape(shape),
        map_from_shape(pose),
        rotation(pose.linear().transpose()),
        translation(-(rotation * pose.translation())),
        surely(shape.shape().has_exact_distance() ? edge / 2 * (1.0 - 1e-9) : 0.0) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
      (i < 4 ? lower : upper).set(i % 4, rotation * corner);
    }
  }
};

bool VoxelMarks::mark(const MarkedShape& shape, const Eigen::Isometry3d& map_from_shape) {
  const Eigen::AlignedBox3d box = shape.shape().bounds(map_from_shape);
  const double brick = brick_edge * edge_;
  const Eigen::Array3d low = (box.min().array() / brick - 1e-9).floor();
  const Eigen::Array3d high = (box.max().array() / brick + 1e-9).floor();
  const bool is_near = low.abs().maxCoeff() < most_cells_away && high.abs().maxCoeff() < most_cells_away;
  const double bricks = (high - low + 1.0).prod();
  if (!is_near || bricks > most_bricks_ || (looks_ += bricks) > most_looks_) return false;
  const Body body(shape, map_from_shape, edge_);
  const Cell first = low.cast<std::int64_t>().matrix(), last = high.cast<std::int64_t>().matrix();
  const double reach = half_diagonal * brick * (1.0 + 1e-9);
  for (std::int64_t z = first.z(); z <= last.z(); ++z) {
    for (std::int64_t y = first.y(); y <= last.y(); ++y) {
      for (std::int64_t x = first.x(); x <= last.x(); ++x) {
        const Cell at(x, y, z);
        const Eigen::Vector3d middle =
            body.rotation * ((at.cast<double>().array() + 0.5) * brick).matrix() + body.translation;
        const double distance = shape.distances(FourPoints::all(middle), reach)[0];
        if (distance > reach) continue;
        const auto known = bricks_.find(at);
        Brick marks = known != bricks_.end() ? known->second : Brick{};
        if (is_full(marks, 0, brick_bits)) continue;
        distance <= -reach ? fill(marks, 0, brick_bits)
                           : mark_eighths(body, at, middle, brick_edge, 0, marks);
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

bool VoxelMarks::touches(const Body& body, const Cell& brick_at, int bit) const {
  const Cell cell = brick_at * brick_edge + cell_of(bit);
  return body.shape.touches(body.map_from_shape, (cell.cast<double>().array() + 0.5) * edge_, edge_);
}

/// Of a cube that the surface may cross: its eight parts.
/// @param at the brick that it lies in @param middle of the cube, shape's frame @param cells along its edge
/// @param first its first bit
void VoxelMarks::mark_eighths(const Body& body, const Cell& at, const Eigen::Vector3d& middle, int cells,
                              int first, Brick& brick) const {
  const int part = cells / 2, count = part * part * part;
  const double size = part * edge_, reach = half_diagonal * size * (1.0 + 1e-9);
  const FourPoints around = FourPoints::all(middle);
  const FourPoints lower = around + size / 2 * body.lower, upper = around + size / 2 * body.upper;
  double distances[8];
  lanes::store(distances, body.shape.distances(lower, reach));
  lanes::store(distances + 4, body.shape.distances(upper, reach));
  for (int i = 0; i < 8; ++i) {
    const int bit = first + i * count;
    if (distances[i] > reach || is_full(brick, bit, count)) continue;
    if (distances[i] <= -reach) {
      fill(brick, bit, count);
    } else if (part > 1) {
      mark_eighths(body, at, i < 4 ? lower.point(i) : upper.point(i - 4), part, bit, brick);
    } else if (distances[i] < body.surely || touches(body, at, bit)) {
      fill(brick, bit, 1);
    }
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
