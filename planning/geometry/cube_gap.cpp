#include "planning/geometry/cube_gap.hpp"

#include <algorithm>

#include "planning/geometry/cube_gap_kernel.hpp"
#include "planning/geometry/four_lanes.hpp"

namespace clearway {
namespace {

/// Registers that any machine has.
struct Portable {
  using Numbers = lanes::Numbers;
  static constexpr int width = lanes::width;

  static Numbers all(double value) { return lanes::all(value); }
  static Numbers load(const double* from) { return lanes::load(from); }
  static void store(double* to, const Numbers& numbers) { lanes::store(to, numbers); }
  static Numbers root(const Numbers& numbers) { return lanes::root(numbers); }
  static Numbers select(const lanes::Places& truths, const Numbers& a, const Numbers& b) {
    return lanes::select(truths, a, b);
  }
  static bool any(const lanes::Places& truths) { return lanes::any(truths); }
};

using Gaps = void (*)(GapKind kind, const GapBody& body, GapLanes& lanes);

Gaps gaps_with(Vectors vectors) {
#ifdef __x86_64__
  if (vectors == Vectors::avx512) return cube_gaps_avx512;
  if (vectors == Vectors::avx2) return cube_gaps_avx2;
#endif
  return cube_gaps_portable;
}

GapBody body_of(const Shape& shape, const Eigen::Isometry3d& pose, double edge, double enough) {
  GapBody body{};
  for (int i = 0; i < 3; ++i) {
    body.middle[i] = pose.translation()[i];
    body.half[i] = 0.5 * shape.edges()[i];
    for (int k = 0; k < 3; ++k) body.axes[i][k] = pose.linear()(k, i);
  }
  body.radius = shape.radius();
  if (shape.kind() == Shape::Kind::capsule || shape.kind() == Shape::Kind::cylinder)
    body.half_length = 0.5 * shape.length();
  body.size = shape.bounding_radius() + edge;
  body.half_edge = 0.5 * edge;
  body.enough = enough;
  return body;
}

GapKind kind_of(const Shape& shape) {
  if (shape.kind() == Shape::Kind::cylinder) return GapKind::cylinder;
  return shape.kind() == Shape::Kind::box ? GapKind::box : GapKind::round;
}

/// The last cube fills up what is left.
void load(std::span<const BodyCube> cubes, GapLanes& lanes) {
  for (std::size_t lane = 0; lane < gap_lanes; ++lane) {
    const BodyCube& cube = cubes[std::min(lane, cubes.size() - 1)];
    for (int axis = 0; axis < 3; ++axis) {
      lanes.center[axis][lane] = cube.center[axis];
      lanes.towards[axis][lane] = cube.towards[axis];
    }
  }
}

CubeGap gap_of(const GapLanes& lanes, std::size_t i) {
  return {lanes.distance[i],
          {lanes.point[0][i], lanes.point[1][i], lanes.point[2][i]},
          {lanes.normal[0][i], lanes.normal[1][i], lanes.normal[2][i]}};
}

}  // namespace

void cube_gaps_portable(GapKind kind, const GapBody& body, GapLanes& lanes) {
  GapKernel<Portable>(body).run(kind, lanes);
}

CubeGaps::CubeGaps(const Shape& shape, const Eigen::Isometry3d& map_from_shape, double edge)
    : shape_(shape), map_from_shape_(map_from_shape), edge_(edge) {}

void CubeGaps::to(std::span<const BodyCube> cubes, double enough, std::span<CubeGap> out) const {
  static const Vectors widest = widest_vectors();
  to(cubes, enough, out, widest);
}

void CubeGaps::to(std::span<const BodyCube> cubes, double enough, std::span<CubeGap> out,
                  Vectors vectors) const {
  if (shape_.kind() == Shape::Kind::convex) {
    for (std::size_t i = 0; i < cubes.size(); ++i) out[i] = proved_gap(cubes[i].center, enough);
    return;
  }
  const Gaps gaps = gaps_with(vectors);
  const GapBody body = body_of(shape_, map_from_shape_, edge_, enough);
  GapLanes lanes;
  for (std::size_t first = 0; first < cubes.size(); first += gap_lanes) {
    const auto part = cubes.subspan(first, std::min<std::size_t>(gap_lanes, cubes.size() - first));
    load(part, lanes);
    gaps(kind_of(shape_), body, lanes);
    for (std::size_t i = 0; i < part.size(); ++i) {
      out[first + i] = gap_of(lanes, i);
      if (lanes.is_open[i] == 0.0) continue;
      const CubeGap proved = proved_gap(part[i].center, enough);
      if (proved.distance > out[first + i].distance) out[first + i] = proved;
    }
  }
}

CubeGap CubeGaps::proved_gap(const Eigen::Vector3d& cube, double enough) const {
  const DistanceBounds bounds = distance_to_cube(shape_, map_from_shape_, cube, edge_, enough);
  if (bounds.upper <= 0.0) return {};
  return {bounds.lower, bounds.point_a, bounds.direction};
}

}  // namespace clearway
