// Points placed in the map, as many at once as a register holds.

#include <algorithm>
#include <cmath>

#include "mapping/scans/point_batch.hpp"
#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapping/scans/point_batch_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Reals = hn::CappedTag<double, PointBatch::size>;
using Floats = hn::Rebind<float, Reals>;
using Wholes = hn::RebindToSigned<Floats>;
using Real = hn::Vec<Reals>;
using Mask = hn::Mask<Reals>;

HWY_INLINE Real all(double number) { return hn::Set(Reals(), number); }

HWY_INLINE unsigned bits_of(Mask lanes) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Reals(), lanes, bits);
  return bits[0];
}

/// @param numbers x, y, z of the points from `lane` on.
HWY_INLINE void place(const float* numbers, const Eigen::Matrix<double, 3, 4>& pose, double factor,
                      std::size_t lane, PointBatch& batch) {
  const auto offsets = hn::Mul(hn::Iota(Wholes(), 0), hn::Set(Wholes(), 3));
  Real sensor[3];
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis)
    sensor[axis] = hn::PromoteTo(Reals(), hn::GatherIndex(Floats(), numbers + axis, offsets));
  float* const stored[3] = {batch.x.data() + lane, batch.y.data() + lane, batch.z.data() + lane};
  std::int32_t* const cells[3] = {batch.cell_x.data() + lane, batch.cell_y.data() + lane,
                                  batch.cell_z.data() + lane};
  Mask finite = hn::Eq(all(0.0), all(0.0)), inside = finite;
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {  // the order of Eigen's sums
    Real sum = hn::Mul(all(pose(axis, 0)), sensor[0]);
    sum = hn::Add(sum, hn::Mul(all(pose(axis, 1)), sensor[1]));
    sum = hn::Add(sum, hn::Mul(all(pose(axis, 2)), sensor[2]));
    const auto placed = hn::DemoteTo(Floats(), hn::Add(all(pose(axis, 3)), sum));
    hn::Store(placed, Floats(), stored[axis]);
    const Real exact = hn::PromoteTo(Reals(), placed);
    finite = hn::And(finite, hn::Lt(hn::Abs(exact), all(HUGE_VAL)));
    const Real cell = hn::Floor(hn::Mul(all(factor), exact));
    inside = hn::And(inside, hn::And(hn::Ge(cell, all(PointBatch::lowest_cell)),
                                     hn::Le(cell, all(PointBatch::highest_cell))));
    hn::Store(hn::DemoteTo(Wholes(), cell), Wholes(), cells[axis]);
  }
  batch.finite |= bits_of(finite) << lane;
  batch.has_cell |= bits_of(hn::And(finite, inside)) << lane;
}

void place_all(const float* numbers, std::size_t count, const Eigen::Matrix<double, 3, 4>& pose,
               double factor, PointBatch& batch) {
  batch.finite = batch.has_cell = 0;
  float padded[3 * PointBatch::size];
  if (count < PointBatch::size) {  // no point is not finite
    std::fill(std::copy_n(numbers, 3 * count, padded), std::end(padded), std::nanf(""));
    numbers = padded;
  }
  for (std::size_t lane = 0; lane < PointBatch::size; lane += hn::MaxLanes(Reals()))
    place(numbers + 3 * lane, pose, factor, lane, batch);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {
namespace {

void place_portable(const Eigen::Vector3f* points, std::size_t count,
                    const Eigen::Isometry3d& map_from_sensor, double factor, PointBatch& batch) {
  batch.finite = batch.has_cell = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d placed = map_from_sensor * points[i].cast<double>();
    const Eigen::Vector3f stored = placed.cast<float>();
    batch.x[i] = stored.x();
    batch.y[i] = stored.y();
    batch.z[i] = stored.z();
    if (!stored.allFinite()) continue;
    batch.finite |= 1U << i;
    const Eigen::Array3d cell = (factor * stored.cast<double>()).array().floor();
    if ((cell < PointBatch::lowest_cell).any() || (cell > PointBatch::highest_cell).any()) continue;
    batch.has_cell |= 1U << i;
    batch.cell_x[i] = static_cast<int>(cell.x());
    batch.cell_y[i] = static_cast<int>(cell.y());
    batch.cell_z[i] = static_cast<int>(cell.z());
  }
}

}  // namespace

void place_points(const Eigen::Vector3f* points, std::size_t count, const Eigen::Isometry3d& map_from_sensor,
                  double factor, InstructionSet set, PointBatch& batch) {
#if HWY_ARCH_X86
  const Eigen::Matrix<double, 3, 4> pose = map_from_sensor.matrix().topRows<3>();
  const float* const numbers = points->data();
  if (set == InstructionSet::avx512) return N_AVX3::place_all(numbers, count, pose, factor, batch);
  if (set == InstructionSet::avx2) return N_AVX2::place_all(numbers, count, pose, factor, batch);
#endif
  place_portable(points, count, map_from_sensor, factor, batch);
}

}  // namespace clearway
#endif  // HWY_ONCE
