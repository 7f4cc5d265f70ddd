// Rays in lockstep, as many to a register as it holds: the choices and sums of walk_ray.

#include <algorithm>
#include <bit>

#include "mapping/scans/ray_window.hpp"
#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapping/scans/ray_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Reals = hn::CappedTag<double, RayPack::size>;
using Wholes = hn::RebindToSigned<Reals>;
using Real = hn::Vec<Reals>;
using Whole = hn::Vec<Wholes>;
using Mask = hn::Mask<Reals>;
constexpr std::size_t width = hn::MaxLanes(Reals());

struct Rays {
  Real next[3], delta[3];
  Whole step[3], at;
};

HWY_INLINE Rays load(const RayPack& pack, std::size_t lane) {
  Rays rays;
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    rays.next[i] = hn::Load(Reals(), pack.next[i] + lane);
    rays.delta[i] = hn::Load(Reals(), pack.delta[i] + lane);
    rays.step[i] = hn::Load(Wholes(), pack.step[i] + lane);
  }
  rays.at = hn::Load(Wholes(), pack.at + lane);
  return rays;
}

/// One cell on: along z when its border is not beyond the others, else along y, else along x. Adding 0 where
/// an axis is not chosen changes nothing.
HWY_INLINE void advance(Rays& r) {
  const Mask z = hn::Le(r.next[2], hn::Min(r.next[0], r.next[1])), before = hn::Le(r.next[1], r.next[0]);
  const Mask chosen[3] = {hn::Not(hn::Or(z, before)), hn::AndNot(z, before), z};
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    r.next[i] = hn::Add(r.next[i], hn::IfThenElseZero(chosen[i], r.delta[i]));
    r.at = hn::Add(r.at, hn::IfThenElseZero(hn::RebindMask(Wholes(), chosen[i]), r.step[i]));
  }
}

HWY_INLINE unsigned bits_of(Mask lanes) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Reals(), lanes, bits);
  return bits[0];
}

/// Lanes whose ray ends where it is: in its last cell, or in a cell that it leaves beyond its reach.
HWY_INLINE unsigned ended(const Rays& r, const RayPack& pack, std::size_t lane) {
  const Real leaves = hn::Min(hn::Min(r.next[0], r.next[1]), r.next[2]);
  const Mask beyond = hn::Gt(leaves, hn::Load(Reals(), pack.reach + lane));
  const auto there = hn::Eq(r.at, hn::Load(Wholes(), pack.end + lane));
  return bits_of(hn::Or(beyond, hn::RebindMask(Reals(), there)));
}

/// Lets lanes stand still in the origin's cell.
HWY_INLINE void halt(Rays& r, unsigned lanes, std::int64_t origin) {
  const std::uint8_t bits[8] = {static_cast<std::uint8_t>(lanes)};
  const Mask idle = hn::LoadMaskBits(Reals(), bits);
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    r.delta[i] = hn::IfThenZeroElse(idle, r.delta[i]);
    r.step[i] = hn::IfThenZeroElse(hn::RebindMask(Wholes(), idle), r.step[i]);
  }
  r.at = hn::IfThenElse(hn::RebindMask(Wholes(), idle), hn::Set(Wholes(), origin), r.at);
}

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void mark(Wholes, Whole at, std::uint8_t* cells) { cells[hn::GetLane(at)] = 1; }
#else
/// Through registers: loads from memory that was just written wait for the stores of earlier marks.
template <class Tag>
HWY_INLINE void mark(Tag tag, hn::Vec<Tag> at, std::uint8_t* cells) {
  if constexpr (hn::MaxLanes(tag) > 2) {
    const hn::Half<Tag> half;
    mark(half, hn::LowerHalf(half, at), cells);
    mark(half, hn::UpperHalf(half, at), cells);
  } else {
    cells[hn::GetLane(at)] = 1;
    cells[hn::ExtractLane(at, 1)] = 1;
  }
}
#endif

/// How many registers of rays go side by side: what leaves all of them in registers.
constexpr std::size_t registers = HWY_MAX_BYTES == 64 ? 2 : 1;

/// Walks the rays from `lane` on, registers * width of them, until none is active.
HWY_INLINE void walk(RayPack& pack, std::size_t lane, std::uint8_t* cells) {
  unsigned active = pack.active >> lane & ((1U << registers * width) - 1U);
  Rays rays[registers];
#pragma GCC unroll 2
  for (std::size_t i = 0; i < registers; ++i) rays[i] = load(pack, lane + i * width);
  const auto mark_all = [&]() HWY_ATTR {
#pragma GCC unroll 2
    for (const Rays& r : rays) mark(Wholes(), r.at, cells);
  };
  std::int64_t done = 0;
  while (active != 0) {
    std::int64_t safe = std::int64_t{1} << 40U;
    for (unsigned left = active; left != 0; left &= left - 1)
      safe = std::min(safe, pack.safe[lane + static_cast<std::size_t>(std::countr_zero(left))]);
    for (; done < safe; ++done) {
#pragma GCC unroll 2
      for (Rays& r : rays) advance(r);
      mark_all();
    }
    unsigned halted = 0;
    while (halted == 0) {
#pragma GCC unroll 2
      for (Rays& r : rays) advance(r);
      ++done;
#pragma GCC unroll 2
      for (std::size_t i = 0; i < registers; ++i)
        halted |= ended(rays[i], pack, lane + i * width) << i * width & active;
      if (halted != 0) {
#pragma GCC unroll 2
        for (std::size_t i = 0; i < registers; ++i)
          halt(rays[i], halted >> i * width & ((1U << width) - 1U), pack.origin);
      }
      mark_all();
    }
    active &= ~halted;
  }
}

void walk_all(RayPack& pack, std::uint8_t* cells) {
  for (std::size_t lane = 0; lane < RayPack::size; lane += registers * width) walk(pack, lane, cells);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {

void walk_pack(RayPack& pack, std::uint8_t* cells, InstructionSet set) {
#if HWY_ARCH_X86
  if (set == InstructionSet::avx512) return N_AVX3::walk_all(pack, cells);
  if (set == InstructionSet::avx2) return N_AVX2::walk_all(pack, cells);
#endif
  HWY_STATIC_DISPATCH(walk_all)(pack, cells);
}

}  // namespace clearway
#endif  // HWY_ONCE
