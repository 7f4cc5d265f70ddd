// Packs of rays, as many at once as a register holds.

#include <algorithm>
#include <cmath>

#include "mapping/scans/ray_window.hpp"
#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapping/scans/ray_pack_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Reals = hn::CappedTag<double, RayPack::size>;
using Wholes = hn::RebindToSigned<Reals>;
using Floats = hn::Rebind<float, Reals>;
using Real = hn::Vec<Reals>;
using Whole = hn::Vec<Wholes>;
using Float = hn::Vec<Floats>;
using Mask = hn::Mask<Reals>;

HWY_INLINE Real all(double number) { return hn::Set(Reals(), number); }

/// RayStarter::start for many rays at once, the same operations in the same precision.
HWY_INLINE void fill(const RayStarter& starter, const RayWindow& window, const RayEnd* rays, std::size_t lane,
                     RayPack& pack) {
  static_assert(sizeof(RayEnd) == 16);
  const hn::RebindToSigned<Floats> offset;
  const auto offsets = hn::Mul(hn::Iota(offset, 0), hn::Set(offset, 4));
  const float* const first = rays[lane].point.data();
  Float point[3], way[3];
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = hn::GatherIndex(Floats(), first + axis, offsets);
    way[axis] = hn::Sub(point[axis], hn::Set(Floats(), starter.origin()[axis]));
  }
  const Float squared =
      hn::Add(hn::Add(hn::Mul(way[0], way[0]), hn::Mul(way[1], way[1])), hn::Mul(way[2], way[2]));
  const Float length = hn::DemoteTo(Floats(), hn::Sqrt(hn::PromoteTo(Reals(), squared)));
  const Real reach = hn::PromoteTo(Reals(), hn::Min(hn::GatherIndex(Floats(), first + 3, offsets), length));

  const Real zero = hn::Zero(Reals()), most = all(std::numeric_limits<double>::max());
  Real crossings = all(-RayPack::unsafe_steps), steps = all(-1.0),
       end = all(static_cast<double>(pack.origin));
  Whole step[3];
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    const Real cell = hn::Floor(hn::Mul(all(starter.factor()), hn::PromoteTo(Reals(), point[i])));
    const Real cells = hn::Sub(cell, all(starter.origin_cell()[static_cast<int>(i)]));
    end = hn::Add(end, hn::Mul(cells, all(static_cast<double>(window.stride(i)))));
    steps = hn::Add(steps, hn::Abs(cells));

    const Real direction = hn::PromoteTo(Reals(), hn::Div(way[i], length)), size = hn::Abs(direction);
    const Mask forward = hn::Gt(direction, zero), moves = hn::Or(hn::Lt(direction, zero), forward);
    const Real border = hn::IfThenElse(forward, all(starter.to_border(i, 1)), all(starter.to_border(i, 0)));
    const Real next = hn::IfThenElse(moves, hn::Div(border, direction), most);
    const Real delta = hn::IfThenElse(moves, hn::Div(all(starter.resolution()), size), most);
    const Real left = hn::Mul(hn::Sub(reach, next), size);
    const Real here = hn::Add(all(1.0), hn::Mul(left, all(starter.factor())));
    crossings = hn::IfThenElse(hn::And(moves, hn::Ge(reach, next)), hn::Add(crossings, here), crossings);
    const Whole ahead = hn::Set(Wholes(), window.stride(i)), back = hn::Set(Wholes(), -window.stride(i));
    step[i] = hn::IfThenElseZero(hn::RebindMask(Wholes(), moves),
                                 hn::IfThenElse(hn::RebindMask(Wholes(), forward), ahead, back));
    hn::Store(next, Reals(), pack.next[i] + lane);
    hn::Store(delta, Reals(), pack.delta[i] + lane);
  }
  hn::Store(hn::Set(Wholes(), pack.origin), Wholes(), pack.at + lane);
  hn::Store(hn::ConvertTo(Wholes(), end), Wholes(), pack.end + lane);
  hn::Store(reach, Reals(), pack.reach + lane);
  const Real safe = hn::Max(hn::Min(steps, crossings), zero);  // 0 for NaN
  hn::Store(hn::ConvertTo(Wholes(), safe), Wholes(), pack.safe + lane);
  const Mask active = hn::Ge(steps, zero);
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Reals(), active, bits);
  pack.active |= static_cast<unsigned>(bits[0]) << lane;
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i)  // the others stay where they are
    hn::Store(hn::IfThenElseZero(hn::RebindMask(Wholes(), active), step[i]), Wholes(), pack.step[i] + lane);
}

void fill_all(const RayStarter& starter, const RayWindow& window, const RayEnd* rays, RayPack& pack) {
  for (std::size_t lane = 0; lane < RayPack::size; lane += hn::MaxLanes(Reals()))
    fill(starter, window, rays, lane, pack);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {
namespace {

void fill_lane(const RayStarter& starter, const RayWindow& window, const RayEnd& end, std::size_t lane,
               RayPack& pack) {
  const RayState ray = starter.start(end);
  double crossings = -RayPack::unsafe_steps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    pack.next[axis][lane] = ray.next[axis];
    pack.delta[axis][lane] = ray.delta[axis];
    pack.step[axis][lane] = ray.step[axis] * window.stride(axis);
    if (ray.reach >= ray.next[axis]) crossings += 1.0 + (ray.reach - ray.next[axis]) / ray.delta[axis];
  }
  pack.at[lane] = pack.origin;
  pack.end[lane] = window.index(ray.end);
  pack.reach[lane] = ray.reach;
  const int steps = (ray.end - ray.cell).cwiseAbs().sum();
  pack.safe[lane] = crossings > 0.0 ? static_cast<std::int64_t>(std::min(crossings, steps - 1.0)) : 0;
  pack.active |= 1U << lane;
}

void fill_portable(const RayStarter& starter, const RayWindow& window, const RayEnd* rays, RayPack& pack) {
  for (std::size_t lane = 0; lane < RayPack::size; ++lane) {
    if (starter.cell(rays[lane].point) != starter.origin_cell()) {
      fill_lane(starter, window, rays[lane], lane, pack);
      continue;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      pack.next[axis][lane] = pack.delta[axis][lane] = 0.0;
      pack.step[axis][lane] = 0;
    }
    pack.at[lane] = pack.end[lane] = pack.origin;
    pack.reach[lane] = 0.0;
    pack.safe[lane] = 0;
  }
}

}  // namespace

void fill_pack(const RayStarter& starter, const RayWindow& window,
               const std::array<RayEnd, RayPack::size>& rays, InstructionSet set, RayPack& pack) {
  pack.active = 0;
  pack.origin = window.index(starter.origin_cell());
#if HWY_ARCH_X86
  if (set == InstructionSet::avx512) return N_AVX3::fill_all(starter, window, rays.data(), pack);
  if (set == InstructionSet::avx2) return N_AVX2::fill_all(starter, window, rays.data(), pack);
#endif
  fill_portable(starter, window, rays.data(), pack);
}

}  // namespace clearway
#endif  // HWY_ONCE
