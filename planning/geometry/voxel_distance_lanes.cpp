// Distances of cubes from bodies, as many cubes at once as a register holds.

#include "planning/geometry/voxel_distance_lanes.hpp"

#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/geometry/voxel_distance_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, distance_lanes>;

struct Truths {
  hn::Mask<Tag> v;
};
struct Numbers {
  hn::Vec<Tag> v;
};

HWY_INLINE Truths operator&(const Truths& a, const Truths& b) { return {hn::And(a.v, b.v)}; }
HWY_INLINE Truths operator~(const Truths& a) { return {hn::Not(a.v)}; }
HWY_INLINE Numbers operator+(const Numbers& a, const Numbers& b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE Numbers operator-(const Numbers& a, const Numbers& b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE Numbers operator*(const Numbers& a, const Numbers& b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE Numbers operator*(double a, const Numbers& b) { return {hn::Mul(hn::Set(Tag(), a), b.v)}; }
HWY_INLINE Numbers operator/(const Numbers& a, const Numbers& b) { return {hn::Div(a.v, b.v)}; }
HWY_INLINE Numbers operator-(const Numbers& a) { return {hn::Neg(a.v)}; }
HWY_INLINE Truths operator<(const Numbers& a, const Numbers& b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE Truths operator<=(const Numbers& a, const Numbers& b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE Truths operator==(const Numbers& a, const Numbers& b) { return {hn::Eq(a.v, b.v)}; }
HWY_INLINE Numbers load_numbers(const double* from) { return {hn::Load(Tag(), from)}; }
HWY_INLINE void store_numbers(double* to, const Numbers& numbers) { hn::Store(numbers.v, Tag(), to); }
HWY_INLINE Numbers root(const Numbers& numbers) { return {hn::Sqrt(numbers.v)}; }
HWY_INLINE Numbers chosen(const Truths& truths, const Numbers& a, const Numbers& b) {
  return {hn::IfThenElse(truths.v, a.v, b.v)};
}
HWY_INLINE bool any(const Truths& truths) { return !hn::AllFalse(Tag(), truths.v); }

/// Points side by side.
struct Points {
  Numbers x, y, z;
};

HWY_INLINE Points operator+(const Points& a, const Points& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Points operator-(const Points& a, const Points& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Points operator*(const Numbers& a, const Points& b) { return {a * b.x, a * b.y, a * b.z}; }

/// The distances of the cubes of a DistanceLanes from one body.
class DistanceKernel {
 public:
  explicit DistanceKernel(const DistanceBody& body)
      : middle_(everywhere(body.middle)),
        half_edges_{number(body.half_edge), number(body.half_edge), number(body.half_edge)},
        body_(body) {}

  void run(DistanceKind kind, DistanceLanes& lanes) const {
    for (int first = 0; first < distance_lanes; first += static_cast<int>(hn::MaxLanes(Tag()))) {
      if (kind == DistanceKind::round) {
        round(lanes, first);
      } else if (kind == DistanceKind::cylinder) {
        projected(Cylinder{*this}, lanes, first);
      } else {
        projected(Box{*this}, lanes, first);
      }
    }
  }

 private:
  using Points3 = double[3][distance_lanes];

  static Numbers number(double value) { return {hn::Set(Tag(), value)}; }
  static Points everywhere(const double* point) {
    return {number(point[0]), number(point[1]), number(point[2])};
  }
  static Points load(const Points3& from, int first) {
    return {load_numbers(from[0] + first), load_numbers(from[1] + first), load_numbers(from[2] + first)};
  }
  static void store(Points3& to, int first, const Points& points) {
    store_numbers(to[0] + first, points.x);
    store_numbers(to[1] + first, points.y);
    store_numbers(to[2] + first, points.z);
  }
  static Points select(const Truths& truths, const Points& a, const Points& b) {
    return {chosen(truths, a.x, b.x), chosen(truths, a.y, b.y), chosen(truths, a.z, b.z)};
  }
  static Numbers dot(const Points& a, const Points& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static Numbers larger(const Numbers& a, const Numbers& b) { return {hn::Max(a.v, b.v)}; }
  static Numbers smaller(const Numbers& a, const Numbers& b) { return {hn::Min(a.v, b.v)}; }
  static Numbers within(const Numbers& a, const Numbers& half) { return smaller(larger(a, -half), half); }
  static Points within(const Points& a, const Points& half) {
    return {within(a.x, half.x), within(a.y, half.y), within(a.z, half.z)};
  }
  static Numbers absolute(const Numbers& a) { return larger(a, -a); }
  static Points absolute(const Points& a) { return {absolute(a.x), absolute(a.y), absolute(a.z)}; }
  static Numbers sum(const Points& a) { return a.x + a.y + a.z; }

  /// From the nearest points of a cylinder to points outside.
  struct Cylinder {
    const DistanceKernel& of;
    const Points axis = everywhere(of.body_.axes[2]);
    const Numbers radius = number(of.body_.radius), half_length = number(of.body_.half_length);
    const Numbers squared_radius = radius * radius;

    Points offset_to(const Points& point) const {
      const Points from_middle = point - of.middle_;
      const Numbers along = dot(from_middle, axis);
      const Points aside = from_middle - along * axis;
      const Numbers squared = dot(aside, aside), beyond = along - within(along, half_length);
      const Numbers outer = number(1.0) - radius / root(squared);
      return beyond * axis + chosen(squared_radius < squared, outer, number(0.0)) * aside;
    }
  };
  /// The same of a box.
  struct Box {
    const DistanceKernel& of;
    const Points x = everywhere(of.body_.axes[0]), y = everywhere(of.body_.axes[1]),
                 z = everywhere(of.body_.axes[2]), half = everywhere(of.body_.half);

    Points offset_to(const Points& point) const {
      const Points from_middle = point - of.middle_;
      const Points local{dot(from_middle, x), dot(from_middle, y), dot(from_middle, z)};
      const Points past = local - within(local, half);
      return past.x * x + past.y * y + past.z * z;
    }
  };

  /// By the plane square to the line between the nearest points of cube and axis. The squared distance of the
  /// axis' point at t, from 0 to 1, is convex, and a parabola between any two planes of the cube's faces; the
  /// sign of its slope at each plane shows between which it is least.
  void round(DistanceLanes& lanes, int first) const {
    const Numbers zero = number(0.0), one = number(1.0), radius = number(body_.radius);
    double along_axis[3], whole_axis[3];
    for (int i = 0; i < 3; ++i) {
      along_axis[i] = body_.half_length * body_.axes[2][i];
      whole_axis[i] = 2.0 * along_axis[i];
    }
    const Points along = everywhere(along_axis), whole = everywhere(whole_axis);
    const Points cube = load(lanes.center, first), middle = middle_ - cube, begin = middle - along;
    const auto slope = [&](const Numbers& t) {
      const Points point = begin + t * whole;
      return dot(whole, point - within(point, half_edges_));
    };
    Numbers low = zero, high = one, slope_low = slope(zero), slope_high = slope(one);
    const auto is_at_low = zero <= slope_low;
    const auto is_at_high = slope_high <= zero;
    const double planes[2] = {-body_.half_edge, body_.half_edge};
    const Numbers* const begins[3] = {&begin.x, &begin.y, &begin.z};
    for (int axis = 0; axis < 3; ++axis) {
      if (whole_axis[axis] == 0.0) continue;
      for (const double plane : planes) {
        const Numbers crossing = (number(plane) - *begins[axis]) / number(whole_axis[axis]);
        const auto is_between = (low < crossing) & (crossing < high);
        const Numbers value = slope(crossing);
        const auto is_low = is_between & (value < zero), is_high = is_between & (zero <= value);
        low = chosen(is_low, crossing, low);
        slope_low = chosen(is_low, value, slope_low);
        high = chosen(is_high, crossing, high);
        slope_high = chosen(is_high, value, slope_high);
      }
    }
    Numbers t = low + (high - low) * (slope_low / (slope_low - slope_high));
    t = chosen(is_at_low, zero, chosen(is_at_high, one, t));
    const Points on_axis = begin + t * whole, offset = within(on_axis, half_edges_) - on_axis;
    const Numbers apart = root(dot(offset, offset));
    const Numbers rounding = 1e-13 * (number(body_.size) + sum(absolute(middle)));
    const auto is_apart = radius + rounding < apart;
    const Points normal = select(is_apart, (one / apart) * offset, Points{});
    const Numbers of_axis = dot(normal, middle) + absolute(dot(normal, along));
    const Numbers distance = -(body_.half_edge * sum(absolute(normal))) - of_axis - radius - rounding;
    store_numbers(lanes.distance + first, chosen(is_apart, larger(distance, zero), zero));
    store(lanes.point, first, select(is_apart, cube + on_axis + radius * normal, Points{}));
    store(lanes.normal, first, normal);
    store_numbers(lanes.is_open + first, zero);
  }

  template <class Body>
  void projected(const Body& body, DistanceLanes& lanes, int first) const {
    constexpr int closely = 4, most = 12;  // looks
    const double edge = 2.0 * body_.half_edge;
    const Points cube = load(lanes.center, first), sizes = absolute(cube);
    const Numbers rounding = 1e-13 * (number(1.0) + larger(larger(sizes.x, sizes.y), sizes.z));
    Points on_cube = cube + within(load(lanes.towards, first) - cube, half_edges_);
    Numbers least = number(0.0);
    Points found{}, normal{};
    auto is_open = rounding == rounding;
    for (int look = 0; look < most && any(is_open); ++look) {
      const Points offset = body.offset_to(on_cube);
      const Numbers distance = root(dot(offset, offset));
      const auto touches = is_open & (distance <= rounding), overlaps = touches & (least <= rounding);
      found = select(overlaps, Points{}, found);
      normal = select(overlaps, Points{}, normal);
      is_open = is_open & ~touches;
      const Points on_body = on_cube - offset;
      // The plane through the body's point, square to the way to the cube's, has the body on one side.
      const Numbers inverse = number(1.0) / distance;
      const Numbers planes = dot(offset, cube - on_body) - body_.half_edge * sum(absolute(offset));
      const Numbers best = larger(planes * inverse - rounding, least);
      least = chosen(is_open, best, least);
      found = select(is_open, on_body, found);
      normal = select(is_open, inverse * offset, normal);
      const Numbers gain = number((look < closely ? 1e-6 : 1e-2) * edge) + 2.0 * rounding;
      is_open = is_open & (gain < distance - best) & (best <= number(body_.enough));
      on_cube = cube + within(on_body - cube, half_edges_);
    }
    store_numbers(lanes.distance + first, least);
    store(lanes.point, first, found);
    store(lanes.normal, first, normal);
    store_numbers(lanes.is_open + first, chosen(is_open, number(1.0), number(0.0)));
  }

  const Points middle_, half_edges_;
  const DistanceBody& body_;
};

void distances(DistanceKind kind, const DistanceBody& body, DistanceLanes& lanes) {
  DistanceKernel(body).run(kind, lanes);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {

void voxel_distances(DistanceKind kind, const DistanceBody& body, DistanceLanes& lanes, InstructionSet set) {
#if HWY_ARCH_X86
  if (set == InstructionSet::avx512) return N_AVX3::distances(kind, body, lanes);
  if (set == InstructionSet::avx2) return N_AVX2::distances(kind, body, lanes);
#endif
  HWY_STATIC_DISPATCH(distances)(kind, body, lanes);
}

}  // namespace clearway
#endif  // HWY_ONCE
