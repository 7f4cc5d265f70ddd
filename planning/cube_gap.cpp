#include "planning/cube_gap.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "planning/four_lanes.hpp"

namespace clearway {
namespace {

using lanes::Numbers;
using lanes::Places;

/// Four points side by side.
struct Points {
  Numbers x, y, z;
};

Points operator+(const Points& a, const Points& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Points operator-(const Points& a, const Points& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Points operator*(const Numbers& a, const Points& b) { return {a * b.x, a * b.y, a * b.z}; }
Numbers dot(const Points& a, const Points& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Points everywhere(const Eigen::Vector3d& point) {
  return {lanes::all(point.x()), lanes::all(point.y()), lanes::all(point.z())};
}
Points within(const Points& a, const Points& most) {
  return {lanes::within(a.x, -most.x, most.x), lanes::within(a.y, -most.y, most.y),
          lanes::within(a.z, -most.z, most.z)};
}
Points select(const Places& truth, const Points& a, const Points& b) {
  return {lanes::select(truth, a.x, b.x), lanes::select(truth, a.y, b.y), lanes::select(truth, a.z, b.z)};
}
Numbers sum_of_sizes(const Points& a) {
  return lanes::absolute(a.x) + lanes::absolute(a.y) + lanes::absolute(a.z);
}
Numbers largest_size(const Points& a) {
  return lanes::larger(lanes::larger(lanes::absolute(a.x), lanes::absolute(a.y)), lanes::absolute(a.z));
}

/// The points of the four cubes from `first`; the last one fills up.
template <class Which>
Points points_of(std::span<const BodyCube> cubes, std::size_t first, const Which& which) {
  std::array<std::array<double, lanes::width>, 3> numbers;
  for (std::size_t lane = 0; lane < lanes::width; ++lane) {
    const Eigen::Vector3d& point = which(cubes[std::min(first + lane, cubes.size() - 1)]);
    for (std::size_t axis = 0; axis < 3; ++axis) numbers[axis][lane] = point[static_cast<Eigen::Index>(axis)];
  }
  return {lanes::load(numbers[0].data()), lanes::load(numbers[1].data()), lanes::load(numbers[2].data())};
}

Points centers(std::span<const BodyCube> cubes, std::size_t first) {
  return points_of(
      cubes, first, [](const BodyCube& cube) -> const auto& { return cube.center; });
}

/// Four gaps side by side.
struct Gaps {
  Numbers distance;
  Points point, normal;

  void store(std::size_t first, std::span<CubeGap> out) const {
    for (std::size_t i = first; i < std::min(first + lanes::width, out.size()); ++i) {
      const int lane = static_cast<int>(i - first);
      out[i] = {distance[lane],
                {point.x[lane], point.y[lane], point.z[lane]},
                {normal.x[lane], normal.y[lane], normal.z[lane]}};
    }
  }
};

/// From the nearest points of a cylinder to points outside.
struct CylinderBody {
  Points middle, axis;
  double radius, half_length;

  Points offset_to(const Points& point) const {
    const Points from_middle = point - middle;
    const Numbers along = dot(from_middle, axis);
    const Points aside = from_middle - along * axis;
    const Numbers squared = dot(aside, aside), half = lanes::all(half_length);
    const Numbers beyond = along - lanes::within(along, -half, half);
    const Numbers outer = lanes::all(1.0) - lanes::all(radius) / lanes::root(squared);
    return beyond * axis +
           lanes::select(lanes::all(radius * radius) < squared, outer, lanes::all(0.0)) * aside;
  }
};

/// The same of a box.
struct BoxBody {
  Points middle, x, y, z, half;

  Points offset_to(const Points& point) const {
    const Points from_middle = point - middle;
    const Points local{dot(from_middle, x), dot(from_middle, y), dot(from_middle, z)};
    const Points past = local - within(local, half);
    return past.x * x + past.y * y + past.z * z;
  }
};

}  // namespace

CubeGaps::CubeGaps(const Shape& shape, const Eigen::Isometry3d& map_from_shape, double edge)
    : shape_(shape),
      map_from_shape_(map_from_shape),
      half_(0.5 * edge),
      middle_(map_from_shape.translation()),
      axis_(map_from_shape.linear().col(2)),
      size_(shape.bounding_radius() + edge) {
  if (shape.kind() == Shape::Kind::capsule || shape.kind() == Shape::Kind::cylinder)
    half_length_ = 0.5 * shape.length();
}

void CubeGaps::to(std::span<const BodyCube> cubes, double enough, std::span<CubeGap> out) const {
  switch (shape_.kind()) {
    case Shape::Kind::sphere:
    case Shape::Kind::capsule:
      return round_gaps(cubes, out);
    case Shape::Kind::cylinder:
      return projected_gaps(
          CylinderBody{everywhere(middle_), everywhere(axis_), shape_.radius(), half_length_}, cubes, enough,
          out);
    case Shape::Kind::box: {
      const auto turned = map_from_shape_.linear();
      return projected_gaps(BoxBody{everywhere(middle_), everywhere(turned.col(0)), everywhere(turned.col(1)),
                                    everywhere(turned.col(2)), everywhere(shape_.edges() / 2)},
                            cubes, enough, out);
    }
    case Shape::Kind::convex:
      break;
  }
  for (std::size_t i = 0; i < cubes.size(); ++i) out[i] = proved_gap(cubes[i].center, enough);
}

CubeGap CubeGaps::proved_gap(const Eigen::Vector3d& cube, double enough) const {
  const DistanceBounds bounds = distance_to_cube(shape_, map_from_shape_, cube, 2.0 * half_, enough);
  if (bounds.upper <= 0.0) return {};
  return {bounds.lower, bounds.point_a, bounds.direction};
}

/// By the plane square to the line between the nearest points of cube and axis. The squared distance of the
/// axis' point at t, from 0 to 1, is a parabola between each two planes of the cube's faces, and convex;
/// where it is least is found from the sign of its slope at each plane.
void CubeGaps::round_gaps(std::span<const BodyCube> cubes, std::span<CubeGap> out) const {
  const Numbers zero = lanes::all(0.0), one = lanes::all(1.0), radius = lanes::all(shape_.radius());
  const Eigen::Vector3d along = half_length_ * axis_, whole = 2.0 * along;
  const Points half = everywhere(Eigen::Vector3d::Constant(half_));
  for (std::size_t first = 0; first < cubes.size(); first += lanes::width) {
    const Points cube = centers(cubes, first), middle = everywhere(middle_) - cube,
                 begin = middle - everywhere(along);
    const auto beyond = [&](const Points& point) { return point - within(point, half); };
    const auto slope = [&](const Numbers& t) {
      return dot(everywhere(whole), beyond(begin + t * everywhere(whole)));
    };
    Numbers low = zero, high = one, slope_low = slope(zero), slope_high = slope(one);
    const Places is_at_low = zero <= slope_low, is_at_high = slope_high <= zero;
    const std::array<const Numbers*, 3> begins{&begin.x, &begin.y, &begin.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double speed = whole[static_cast<Eigen::Index>(axis)];
      if (speed == 0.0) continue;
      for (const double plane : {-half_, half_}) {
        const Numbers crossing = (lanes::all(plane) - *begins[axis]) / lanes::all(speed);
        const Places is_between = (low < crossing) & (crossing < high);
        const Numbers value = slope(crossing);
        const Places is_low = is_between & (value < zero), is_high = is_between & (zero <= value);
        low = lanes::select(is_low, crossing, low);
        slope_low = lanes::select(is_low, value, slope_low);
        high = lanes::select(is_high, crossing, high);
        slope_high = lanes::select(is_high, value, slope_high);
      }
    }
    Numbers t = low + (high - low) * (slope_low / (slope_low - slope_high));
    t = lanes::select(is_at_low, zero, lanes::select(is_at_high, one, t));
    const Points on_axis = begin + t * everywhere(whole), offset = within(on_axis, half) - on_axis;
    const Numbers apart = lanes::root(dot(offset, offset));
    const Numbers rounding = 1e-13 * (lanes::all(size_) + sum_of_sizes(middle));
    const Places is_apart = radius + rounding < apart;
    const Points normal = select(is_apart, (one / apart) * offset, Points{});
    const Numbers of_axis = dot(normal, middle) + lanes::absolute(dot(normal, everywhere(along)));
    const Numbers distance = -(half_ * sum_of_sizes(normal)) - of_axis - radius - rounding;
    Gaps{lanes::select(is_apart, lanes::larger(distance, zero), zero),
         select(is_apart, cube + on_axis + radius * normal, Points{}), normal}
        .store(first, out);
  }
}

template <class Body>
void CubeGaps::projected_gaps(const Body& body, std::span<const BodyCube> cubes, double enough,
                              std::span<CubeGap> out) const {
  constexpr int closely = 4, most = 12;  // looks
  const double edge = 2.0 * half_;
  const Points half = everywhere(Eigen::Vector3d::Constant(half_));
  for (std::size_t first = 0; first < cubes.size(); first += lanes::width) {
    const Points cube = centers(cubes, first);
    const Points towards = points_of(
        cubes, first, [](const BodyCube& seen) -> const auto& { return seen.towards; });
    const Numbers rounding = 1e-13 * (lanes::all(1.0) + largest_size(cube));
    Points on_cube = cube + within(towards - cube, half);
    Gaps gaps;
    Places is_open{~lanes::PlacePair{}, ~lanes::PlacePair{}};
    for (int look = 0; look < most && lanes::any(is_open); ++look) {
      const Points offset = body.offset_to(on_cube);
      const Numbers distance = lanes::root(dot(offset, offset));
      const Places touches = is_open & (distance <= rounding);
      const Places overlaps = touches & (gaps.distance <= rounding);
      gaps.point = select(overlaps, Points{}, gaps.point);
      gaps.normal = select(overlaps, Points{}, gaps.normal);
      is_open = is_open & ~touches;
      const Points on_body = on_cube - offset;
      // The plane through the body's point, square to the way to the cube's, has the body on one side.
      const Numbers apart =
          (dot(offset, cube - on_body) - half_ * sum_of_sizes(offset)) / distance - rounding;
      const Numbers best = lanes::larger(apart, gaps.distance);
      gaps.distance = lanes::select(is_open, best, gaps.distance);
      gaps.point = select(is_open, on_body, gaps.point);
      gaps.normal = select(is_open, (lanes::all(1.0) / distance) * offset, gaps.normal);
      const Numbers gain = lanes::all((look < closely ? 1e-6 : 1e-2) * edge) + 2.0 * rounding;
      is_open = is_open & (gain < distance - best) & (best <= lanes::all(enough));
      on_cube = cube + within(on_body - cube, half);
    }
    gaps.store(first, out);
    for (std::size_t i = first; i < std::min(first + lanes::width, cubes.size()); ++i) {
      const int lane = static_cast<int>(i - first);
      if (is_open[lane] != 0) {
        const CubeGap proved = proved_gap(cubes[i].center, enough);
        if (proved.distance > out[i].distance) out[i] = proved;
      }
    }
  }
}

}  // namespace clearway
