#include "planning/geometry/voxel_distance.hpp"

#include <algorithm>

#include "planning/geometry/voxel_distance_lanes.hpp"

namespace clearway {
namespace {

DistanceBody body_of(const Shape& shape, const Eigen::Isometry3d& pose, double edge, double enough) {
  DistanceBody body{};
  for (int i = 0; i < 3; ++i) {
    body.middle[i] = pose.translation()[i];
    body.half[i] = 0.5 * shape.edges()[i];
    for (int k = 0; k < 3; ++k) body.axes[i][k] = pose.linear()(k, i);
  }
  body.radius = shape.radius();
  body.half_length = 0.5 * shape.length();
  body.size = shape.bounding_radius() + edge;
  body.half_edge = 0.5 * edge;
  body.enough = enough;
  return body;
}

DistanceKind kind_of(const Shape& shape) {
  if (shape.is_rounded()) return DistanceKind::round;
  return shape.is_axial() ? DistanceKind::cylinder : DistanceKind::box;
}

/// The last cube fills up what is left.
void load(std::span<const NearVoxel> cubes, DistanceLanes& lanes) {
  for (std::size_t lane = 0; lane < distance_lanes; ++lane) {
    const NearVoxel& cube = cubes[std::min(lane, cubes.size() - 1)];
    for (int axis = 0; axis < 3; ++axis) {
      lanes.center[axis][lane] = cube.center[axis];
      lanes.towards[axis][lane] = cube.towards[axis];
    }
  }
}

VoxelDistance distance_of(const DistanceLanes& lanes, std::size_t i) {
  return {lanes.distance[i],
          {lanes.point[0][i], lanes.point[1][i], lanes.point[2][i]},
          {lanes.normal[0][i], lanes.normal[1][i], lanes.normal[2][i]}};
}

}  // namespace

VoxelDistances::VoxelDistances(const Shape& shape, const Eigen::Isometry3d& map_from_shape, double edge)
    : shape_(shape), map_from_shape_(map_from_shape), edge_(edge) {}

void VoxelDistances::to(std::span<const NearVoxel> cubes, double enough, std::span<VoxelDistance> out) const {
  static const InstructionSet widest = best_instruction_set();
  to(cubes, enough, out, widest);
}

void VoxelDistances::to(std::span<const NearVoxel> cubes, double enough, std::span<VoxelDistance> out,
                        InstructionSet vectors) const {
  if (!shape_.has_exact_distance()) {
    for (std::size_t i = 0; i < cubes.size(); ++i) out[i] = proved_distance(cubes[i].center, enough);
    return;
  }
  const DistanceBody body = body_of(shape_, map_from_shape_, edge_, enough);
  DistanceLanes lanes;
  for (std::size_t first = 0; first < cubes.size(); first += distance_lanes) {
    const auto part = cubes.subspan(first, std::min<std::size_t>(distance_lanes, cubes.size() - first));
    load(part, lanes);
    voxel_distances(kind_of(shape_), body, lanes, vectors);
    for (std::size_t i = 0; i < part.size(); ++i) {
      out[first + i] = distance_of(lanes, i);
      if (lanes.is_open[i] == 0.0) continue;
      const VoxelDistance proved = proved_distance(part[i].center, enough);
      if (proved.distance > out[first + i].distance) out[first + i] = proved;
    }
  }
}

VoxelDistance VoxelDistances::proved_distance(const Eigen::Vector3d& cube, double enough) const {
  const DistanceBounds bounds = distance_to_cube(shape_, map_from_shape_, cube, edge_, enough);
  if (bounds.upper <= 0.0) return {};
  return {bounds.lower, bounds.point_a, bounds.direction};
}

}  // namespace clearway
