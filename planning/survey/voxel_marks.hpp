#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "planning/geometry/four_points.hpp"
#include "planning/geometry/shape.hpp"

namespace clearway {

/// Index of a voxel of a map's grid: it spans [cell, cell + 1] times the edge. Wider than a map's own keys,
/// for bodies may be far outside of any map.
using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

/// A shape that is ready to be asked often on which side of it a cube lies.
class MarkedShape {
 public:
  explicit MarkedShape(const Shape& shape);
  const Shape& shape() const { return shape_; }

  /// Distances of points (shape's frame) from the surface, negative inside; outside of a hull lower bounds,
  /// and any above `enough` where all four are.
  lanes::Numbers distances(const FourPoints& points, double enough = HUGE_VAL) const;

  /// True unless the placed shape is proved apart from the cube: touching counts.
  bool touches(const Eigen::Isometry3d& pose, const Eigen::Vector3d& center, double edge) const;

 private:
  Shape shape_;
  std::vector<Eigen::Vector4d> planes_;  ///< of a hull's faces: outward normal, offset
};

/// The set of voxels that bodies touch, one bit each, in bricks of 8 x 8 x 8 voxels. Marking descends from
/// bricks to voxels and passes by cubes that are marked already: a body that moves on costs little more than
/// the surface that it enters anew.
class VoxelMarks {
 public:
  static constexpr int brick_edge = 8;  ///< voxels
  using Brick = std::array<std::uint64_t, 8>;

  /// @param voxel_edge metres @param most_bricks that are looked at in one body's box, or stored
  /// @param most_looks at bricks, of all shapes together
  explicit VoxelMarks(double voxel_edge, double most_bricks = 5e5, double most_looks = 1e8)
      : edge_(voxel_edge), most_bricks_(most_bricks), most_looks_(most_looks) {}

  /// Marks all voxels that the placed shape touches. False, and nothing is marked, when there are too many,
  /// or too many bricks in the boxes of all shapes so far.
  bool mark(const MarkedShape& shape, const Eigen::Isometry3d& map_from_shape);

  double edge() const { return edge_; }
  std::size_t count() const;

  /// Calls `visit(first cell, number of marked voxels)` for each brick, in no particular order; true asks for
  /// its voxels, one by one, through `visit_voxel(cell)`.
  void visit(const std::function<bool(const Cell&, std::size_t)>& visit,
             const std::function<void(const Cell&)>& visit_voxel) const;

 private:
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };
  struct Body;
  bool touches(const Body& body, const Cell& brick_at, int bit) const;
  void mark_eighths(const Body& body, const Cell& at, const Eigen::Vector3d& middle, int cells, int first,
                    Brick& brick) const;

  double edge_, most_bricks_, most_looks_, looks_ = 0.0;
  std::unordered_map<Cell, Brick, CellHash> bricks_;
};

}  // namespace clearway
