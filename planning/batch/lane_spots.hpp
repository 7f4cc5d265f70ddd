// Not part of the installed library. Included once for each instruction set, so there is no #pragma once.

#include <bit>
#include <cstddef>
#include <cstdint>

#if defined(CLEARWAY_LANE_SPOTS) == defined(HWY_TARGET_TOGGLE)
#ifdef CLEARWAY_LANE_SPOTS
#undef CLEARWAY_LANE_SPOTS
#else
#define CLEARWAY_LANE_SPOTS
#endif

#include "planning/batch/lane_vectors.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

/// Middles of spheres in those lanes that are asked for, side by side without gaps: a look at the field costs
/// as much in a lane that nobody asks for. In the same order whatever the registers.
struct Spots {
  /// Who adds the lanes of one sphere looks at the last `lane_count` as soon as there are so many.
  static constexpr std::size_t most = 2 * lane_count;
  alignas(64) float x[most] = {}, y[most] = {}, z[most] = {}, need[most] = {};
  std::int32_t lane[most] = {}, sphere[most] = {};
  std::size_t count = 0;

  Point point(std::size_t k) const { return {at(x, k), at(y, k), at(z, k)}; }
  Vector needed(std::size_t k) const { return at(need, k); }

  /// The lanes of a register whose first one is `first`.
  /// @param needs what the distance of the middle to what blocks it is compared with, metres
  HWY_INLINE void add(const Point& point, Vector needs, unsigned lanes, std::size_t first, int of) {
    const auto numbers = hn::Iota(WholeTag(), static_cast<std::int32_t>(first));
    append(point, needs, numbers, hn::Set(WholeTag(), of), lanes);
  }

  /// Those of the register at k.
  HWY_INLINE void add(const Spots& from, std::size_t k, unsigned lanes) {
    const auto whole = [&](const std::int32_t* row) HWY_ATTR { return hn::LoadU(WholeTag(), row + k); };
    append(from.point(k), from.needed(k), whole(from.lane), whole(from.sphere), lanes);
  }

 private:
  static HWY_INLINE Vector at(const float* row, std::size_t k) { return hn::LoadU(Tag(), row + k); }

  HWY_INLINE void append(const Point& point, Vector needs, Whole lane_numbers, Whole spheres,
                         unsigned lanes) {
    const Mask mask = mask_of(lanes);
    pack(point.x, mask, x + count), pack(point.y, mask, y + count), pack(point.z, mask, z + count);
    pack(needs, mask, need + count);
    pack(lane_numbers, mask, lane + count), pack(spheres, mask, sphere + count);
    count += static_cast<std::size_t>(std::popcount(lanes));
  }
};

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
