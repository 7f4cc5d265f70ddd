// Not part of the installed library. Included once for each instruction set, so there is no #pragma once.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "planning/batch/pair_table.hpp"

#if defined(CLEARWAY_LANE_PROOFS) == defined(HWY_TARGET_TOGGLE)
#ifdef CLEARWAY_LANE_PROOFS
#undef CLEARWAY_LANE_PROOFS
#else
#define CLEARWAY_LANE_PROOFS
#endif

#include "planning/batch/lane_vectors.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

/// Where a table proves all pairs apart, and where it proves that some overlap.
struct Proofs {
  unsigned apart = 0, overlap = 0;  ///< a bit for each lane of a register
};

/// PairTable::cells_between for values of one joint; below 0 outside the limits.
HWY_INLINE Whole cells_of(const PairTable::Cells& cells, std::size_t joint, const double* values) {
  using DoubleTag = hn::Repartition<double, Tag>;
  using HalfTag = hn::Rebind<std::int32_t, DoubleTag>;
  const auto number = [](double x) HWY_ATTR { return hn::Set(DoubleTag(), x); };
  const auto lower = number(cells.lower[joint]), per_unit = number(cells.per_unit[joint]);
  const auto end = number(cells.counts[joint]);
  alignas(64) std::int32_t found[lane_count];
  for (std::size_t lane = 0; lane < hn::Lanes(Tag()); lane += hn::Lanes(DoubleTag())) {
    const auto at = hn::Mul(hn::Sub(hn::Load(DoubleTag(), values + lane), lower), per_unit);
    const auto is_inside = hn::And(hn::Ge(at, number(0.0)), hn::Le(at, end));
    hn::Store(hn::DemoteTo(HalfTag(), hn::IfThenElse(is_inside, at, number(-1.0))), HalfTag(), found + lane);
  }
  return hn::Min(hn::Load(WholeTag(), found), hn::Set(WholeTag(), cells.counts[joint] - 1));
}

/// PairTable::proof in lanes of configurations, of those that are asked for.
/// @param q of each joint, values in lanes. @param lane the first one of the register
inline Proofs proofs(const PairTable& table, const LaneDoubles* q, std::size_t lane, unsigned asked) {
  const PairTable::Cells cells = table.cells();
  const LaneDoubles& first = q[table.joints()[0]];
  const LaneDoubles& second = table.joints()[1] < 0 ? first : q[table.joints()[1]];
  Whole cell = cells_of(cells, 0, first.at + lane), column = hn::Zero(WholeTag());
  if (table.joints()[1] >= 0) column = cells_of(cells, 1, second.at + lane);
  const auto is_cell = hn::Gt(hn::Min(cell, column), hn::Set(WholeTag(), -1));
  cell = hn::Add(hn::Mul(cell, hn::Set(WholeTag(), cells.counts[1])), column);
  cell = hn::IfThenElseZero(is_cell, cell);
  asked &= bits(hn::RebindMask(Tag(), is_cell));
  // Without atomics beside others' relaxed stores: a byte is what it was or what it becomes, and either is
  // true.
  const auto read = [&]() HWY_ATTR {
    const auto* bytes = reinterpret_cast<const std::int32_t*>(cells.proofs);
    return hn::And(hn::GatherOffset(WholeTag(), bytes, cell), hn::Set(WholeTag(), 255));
  };
  Whole found = read();
  const auto are = [&](PairTable::Proof proof) HWY_ATTR {
    return asked & bits(hn::RebindMask(Tag(), hn::Eq(found, hn::Set(WholeTag(), static_cast<int>(proof)))));
  };
  if (unsigned left = are(PairTable::Proof::unknown); left != 0) {
    for (; left != 0; left &= left - 1U) {
      const std::size_t at = lane + static_cast<std::size_t>(std::countr_zero(left));
      table.proof({first.at[at], second.at[at]});
    }
    found = read();
  }
  return {are(PairTable::Proof::apart), are(PairTable::Proof::overlap)};
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
