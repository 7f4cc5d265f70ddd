// The marks of a window as bits.

#include <cstring>

#include "mapping/scans/ray_window.hpp"
#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapping/scans/ray_window_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;

bool take(std::uint8_t* first, std::int64_t stride_y, std::int64_t stride_z, std::uint64_t (&masks)[16]) {
  const auto none = hn::Zero(Bytes());
  std::uint64_t any = 0;
  for (unsigned row = 0; row < 16; ++row) {
    const std::uint8_t* const bytes = first + (row & 3U) * stride_y + (row >> 2U) * stride_z;
    std::uint64_t mask = 0;
#pragma GCC unroll 2
    for (std::size_t i = 0; i < 64; i += hn::MaxLanes(Bytes())) {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(Bytes(), hn::Ne(hn::Load(Bytes(), bytes + i), none), bits);
      std::uint64_t part;
      std::memcpy(&part, bits, 8);
      mask |= part << i;
    }
    masks[row] = mask;
    any |= mask;
  }
  if (any == 0) return false;
  for (unsigned row = 0; row < 16; ++row)
    std::memset(first + (row & 3U) * stride_y + (row >> 2U) * stride_z, 0, 64);
  return true;
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {
namespace {

bool take_portable(std::uint8_t* first, std::int64_t stride_y, std::int64_t stride_z,
                   std::uint64_t (&masks)[16]) {
  std::uint64_t any = 0;
  for (unsigned row = 0; row < 16; ++row) {
    std::uint8_t* const bytes = first + (row & 3U) * stride_y + (row >> 2U) * stride_z;
    std::uint64_t mask = 0;
    for (unsigned i = 0; i < 8; ++i) {
      std::uint64_t eight;
      std::memcpy(&eight, bytes + 8 * i, 8);
      mask |= eight * 0x0102040810204080U >> 56U << 8 * i;  // one bit a byte, side by side
    }
    if (mask != 0) std::memset(bytes, 0, 64);
    masks[row] = mask;
    any |= mask;
  }
  return any != 0;
}

}  // namespace

bool take_masks(std::uint8_t* first, std::int64_t stride_y, std::int64_t stride_z, InstructionSet set,
                std::uint64_t (&masks)[16]) {
#if HWY_ARCH_X86
  if (set == InstructionSet::avx512) return N_AVX3::take(first, stride_y, stride_z, masks);
  if (set == InstructionSet::avx2) return N_AVX2::take(first, stride_y, stride_z, masks);
#endif
  return take_portable(first, stride_y, stride_z, masks);
}

}  // namespace clearway
#endif  // HWY_ONCE
