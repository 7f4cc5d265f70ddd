// Not part of the installed library. Included once for each instruction set, so there is no #pragma once.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "planning/batch/configuration_block.hpp"

#if defined(CLEARWAY_LANE_PACKS) == defined(HWY_TARGET_TOGGLE)
#ifdef CLEARWAY_LANE_PACKS
#undef CLEARWAY_LANE_PACKS
#else
#define CLEARWAY_LANE_PACKS
#endif

#include "planning/batch/lane_vectors.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

/// Where a point of the frame is, at the packed poses from k on.
HWY_INLINE Point placed(const PackedPoses& poses, const SphereTree::FloatSphere& sphere, std::size_t k) {
  const auto row = [&](int i) HWY_ATTR { return hn::Load(Tag(), poses.rows[i] + k); };
  const Vector x = all(sphere.x), y = all(sphere.y), z = all(sphere.z);
  const auto along = [&](int i) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(row(3 * i), x), hn::Mul(row(3 * i + 1), y)),
                   hn::Add(hn::Mul(row(3 * i + 2), z), row(9 + i)));
  };
  return {along(0), along(1), along(2)};
}

HWY_INLINE void append_places(std::size_t row, std::size_t lane, unsigned lanes, PackedPoses& to) {
  const auto first = static_cast<std::int32_t>(row * lane_count + lane);
  pack(hn::Iota(WholeTag(), first), mask_of(lanes), to.place + to.count);
  to.count += static_cast<std::size_t>(std::popcount(lanes));
}

/// The poses of a frame in those lanes.
HWY_INLINE void append(const LaneFloats* pose, std::size_t row, std::size_t lane, unsigned lanes,
                       PackedPoses& to) {
  const Mask mask = mask_of(lanes);
  for (int i = 0; i < 12; ++i) pack(load(pose[i], lane), mask, to.rows[i] + to.count);
  append_places(row, lane, lanes, to);
}

/// Those lanes of the poses from k on.
HWY_INLINE void append(const PackedPoses& from, std::size_t k, unsigned lanes, PackedPoses& to) {
  const Mask mask = mask_of(lanes);
  for (int i = 0; i < 12; ++i) pack(hn::Load(Tag(), from.rows[i] + k), mask, to.rows[i] + to.count);
  pack(hn::Load(WholeTag(), from.place + k), mask, to.place + to.count);
  to.count += static_cast<std::size_t>(std::popcount(lanes));
}

/// The pose of b seen from a.
HWY_INLINE void append_relative(const LaneFloats* a, const LaneFloats* b, std::size_t row, std::size_t lane,
                                unsigned lanes, PackedPoses& to) {
  const Mask mask = mask_of(lanes);
  const auto column = [&](const LaneFloats* rows, int i) HWY_ATTR {
    return Point{load(rows[i], lane), load(rows[3 + i], lane), load(rows[6 + i], lane)};
  };
  const Point way = minus(load_point(b + 9, lane), load_point(a + 9, lane));
  for (int i = 0; i < 3; ++i) {
    const Point axis = column(a, i);
    const auto along = [&](const Point& of) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(axis.x, of.x), hn::Mul(axis.y, of.y)), hn::Mul(axis.z, of.z));
    };
    for (int k = 0; k < 3; ++k) pack(along(column(b, k)), mask, to.rows[3 * i + k] + to.count);
    pack(along(way), mask, to.rows[9 + i] + to.count);
  }
  append_places(row, lane, lanes, to);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
