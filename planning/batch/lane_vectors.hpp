// Not part of the installed library. Included once for each instruction set (hwy/foreach_target.h), so there
// is no #pragma once.

#include <cstdint>
#include <cstring>

#include "planning/batch/lanes.hpp"

#if defined(CLEARWAY_LANE_VECTORS) == defined(HWY_TARGET_TOGGLE)
#ifdef CLEARWAY_LANE_VECTORS
#undef CLEARWAY_LANE_VECTORS
#else
#define CLEARWAY_LANE_VECTORS
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, lane_count>;
using WholeTag = hn::RebindToSigned<Tag>;
using Vector = hn::Vec<Tag>;
using Whole = hn::Vec<WholeTag>;
using Mask = hn::Mask<Tag>;

struct Point {
  Vector x, y, z;
};

/// A bit for each lane of a register.
constexpr unsigned all_bits = (1U << hn::MaxLanes(Tag())) - 1U;

HWY_INLINE Vector load(const LaneFloats& row, std::size_t lane) { return hn::Load(Tag(), row.at + lane); }
HWY_INLINE void store(Vector numbers, LaneFloats& row, std::size_t lane) {
  hn::Store(numbers, Tag(), row.at + lane);
}
HWY_INLINE Vector all(float number) { return hn::Set(Tag(), number); }
HWY_INLINE Point load_point(const LaneFloats* rows, std::size_t lane) {
  return {load(rows[0], lane), load(rows[1], lane), load(rows[2], lane)};
}
HWY_INLINE void store_point(const Point& point, LaneFloats* rows, std::size_t lane) {
  store(point.x, rows[0], lane), store(point.y, rows[1], lane), store(point.z, rows[2], lane);
}
HWY_INLINE Point minus(const Point& a, const Point& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Point plus(const Point& a, const Point& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Point times(Vector s, const Point& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE Point cross(const Point& a, const Point& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vector squared(const Point& a) {
  return hn::Add(hn::Add(hn::Mul(a.x, a.x), hn::Mul(a.y, a.y)), hn::Mul(a.z, a.z));
}

/// The bits of a mask, from lane 0 on.
HWY_INLINE unsigned bits(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Tag(), mask, bytes);
  std::uint32_t mask_bits = 0;
  std::memcpy(&mask_bits, bytes, sizeof(mask_bits));
  return mask_bits & all_bits;
}

/// The mask of bits.
HWY_INLINE Mask mask_of(unsigned lanes) {
  std::uint8_t bytes[8] = {};
  std::memcpy(bytes, &lanes, sizeof(lanes));
  return hn::LoadMaskBits(Tag(), bytes);
}

/// Of the lanes from k on those that a list of so many has.
HWY_INLINE unsigned lanes_in_use(std::size_t count, std::size_t k) {
  return count - k >= hn::Lanes(Tag()) ? all_bits : (1U << (count - k)) - 1U;
}

/// The numbers of the mask's lanes side by side; a whole register is written.
HWY_INLINE void pack(Vector numbers, Mask mask, float* to) {
  hn::StoreU(hn::Compress(numbers, mask), Tag(), to);
}
HWY_INLINE void pack(Whole numbers, Mask mask, std::int32_t* to) {
  hn::StoreU(hn::Compress(numbers, hn::RebindMask(WholeTag(), mask)), WholeTag(), to);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
