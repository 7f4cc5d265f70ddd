#include "planning/geometry/farthest_vertex.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/system/highway_targets.hpp"
#include "mapping/system/instruction_set.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/geometry/farthest_vertex.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using DoubleTag = hn::CappedTag<double, 8>;

/// The first of the points at which `number_at(x, y, z)` is largest. Their x, y and z lie in turn; they are a
/// whole number of registers.
template <class NumberAt>
HWY_ATTR std::size_t first_largest(const double* coordinates, std::size_t count, const NumberAt& number_at,
                                   double& largest) {
  const DoubleTag d;
  const auto at = [&](std::size_t i) HWY_ATTR { return hn::Set(d, static_cast<double>(i)); };
  auto most = hn::Set(d, -HUGE_VAL), first_of_most = hn::Zero(d);  // of each lane alone
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Vec<DoubleTag> x, y, z;
    hn::LoadInterleaved3(d, coordinates + 3 * i, x, y, z);
    const auto here = number_at(x, y, z);
    const auto is_farther = hn::Gt(here, most);
    most = hn::IfThenElse(is_farther, here, most);
    first_of_most = hn::IfThenElse(is_farther, at(i), first_of_most);
  }
  const auto farthest = hn::MaxOfLanes(d, most);
  const auto places = hn::Add(first_of_most, hn::Iota(d, 0.0));
  const auto found = hn::IfThenElse(hn::Eq(most, farthest), places, hn::Set(d, HUGE_VAL));
  largest = hn::GetLane(farthest);
  return static_cast<std::size_t>(hn::GetLane(hn::MinOfLanes(d, found)));
}

std::size_t farthest_along(const double* coordinates, std::size_t count, const Eigen::Vector3d& direction,
                           double& largest) {
  const DoubleTag d;
  const auto dx = hn::Set(d, direction.x()), dy = hn::Set(d, direction.y()), dz = hn::Set(d, direction.z());
  const auto dot = [&](const auto& x, const auto& y, const auto& z)
                       HWY_ATTR { return hn::Add(hn::Add(hn::Mul(dx, x), hn::Mul(dy, y)), hn::Mul(dz, z)); };
  return first_largest(coordinates, count, dot, largest);
}

std::size_t farthest_from(const double* coordinates, std::size_t count, const Eigen::Vector3d& point,
                          double& largest) {
  const DoubleTag d;
  const auto px = hn::Set(d, point.x()), py = hn::Set(d, point.y()), pz = hn::Set(d, point.z());
  const auto squared_distance = [&](const auto& x, const auto& y, const auto& z) HWY_ATTR {
    const auto dx = hn::Sub(x, px), dy = hn::Sub(y, py), dz = hn::Sub(z, pz);
    return hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  };
  return first_largest(coordinates, count, squared_distance, largest);
}

double largest_norm_of(const double* coordinates, std::size_t count) {
  const DoubleTag d;
  auto most = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Vec<DoubleTag> x, y, z;
    hn::LoadInterleaved3(d, coordinates + 3 * i, x, y, z);
    most = hn::Max(most, hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
  }
  return hn::GetLane(hn::MaxOfLanes(d, most));
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {
namespace {

constexpr std::size_t widest = 8;  ///< points in a register at most

InstructionSet machine() {
  static const InstructionSet vectors = best_instruction_set();
  return vectors;
}

std::size_t farthest_along(const std::vector<Eigen::Vector3d>& points, std::size_t count,
                           const Eigen::Vector3d& direction, double& largest) {
  const double* coordinates = points.front().data();
#if HWY_ARCH_X86
  if (machine() == InstructionSet::avx512)
    return N_AVX3::farthest_along(coordinates, count, direction, largest);
  if (machine() == InstructionSet::avx2)
    return N_AVX2::farthest_along(coordinates, count, direction, largest);
#endif
  return HWY_STATIC_DISPATCH(farthest_along)(coordinates, count, direction, largest);
}

std::size_t farthest_from(const std::vector<Eigen::Vector3d>& points, std::size_t count,
                          const Eigen::Vector3d& point, double& largest) {
  const double* coordinates = points.front().data();
#if HWY_ARCH_X86
  if (machine() == InstructionSet::avx512) return N_AVX3::farthest_from(coordinates, count, point, largest);
  if (machine() == InstructionSet::avx2) return N_AVX2::farthest_from(coordinates, count, point, largest);
#endif
  return HWY_STATIC_DISPATCH(farthest_from)(coordinates, count, point, largest);
}

double largest_norm_of(const std::vector<Eigen::Vector3d>& points, std::size_t count) {
  const double* coordinates = points.front().data();
#if HWY_ARCH_X86
  if (machine() == InstructionSet::avx512) return N_AVX3::largest_norm_of(coordinates, count);
  if (machine() == InstructionSet::avx2) return N_AVX2::largest_norm_of(coordinates, count);
#endif
  return HWY_STATIC_DISPATCH(largest_norm_of)(coordinates, count);
}

}  // namespace

std::size_t farthest_vertex(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction) {
  const std::size_t together = points.size() / widest * widest;
  std::size_t best = 0;
  double largest = direction.dot(points.front());
  if (together > widest) best = farthest_along(points, together, direction, largest);
  for (std::size_t i = together > widest ? together : 1; i < points.size(); ++i) {
    const double dot = direction.dot(points[i]);
    if (!(dot > largest)) continue;
    best = i;
    largest = dot;
  }
  return best;
}

std::size_t farthest_from(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& point) {
  const std::size_t together = points.size() / widest * widest;
  double largest = -HUGE_VAL;
  std::size_t best = together > 0 ? farthest_from(points, together, point, largest) : 0;
  for (std::size_t i = together; i < points.size(); ++i) {
    const double squared = (points[i] - point).squaredNorm();
    if (!(squared > largest)) continue;
    best = i;
    largest = squared;
  }
  return best;
}

double largest_squared_norm(const std::vector<Eigen::Vector3d>& points) {
  const std::size_t together = points.size() / widest * widest;
  double largest = together > 0 ? largest_norm_of(points, together) : 0.0;
  for (std::size_t i = together; i < points.size(); ++i) largest = std::max(largest, points[i].squaredNorm());
  return largest;
}

}  // namespace clearway
#endif  // HWY_ONCE
