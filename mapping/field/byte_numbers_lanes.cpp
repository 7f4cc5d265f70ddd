// Square roots of many distances at once. Single precision is exact here: a product that is no whole number
// lies farther from the next one (1 / 2048) than two roundings reach.

#include "mapping/field/byte_numbers.hpp"
#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapping/field/byte_numbers_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void number_all(const std::uint16_t* squared, std::size_t count, float units_a_half, std::uint8_t* out) {
  const hn::ScalableTag<float> floats;
  const hn::Rebind<std::int32_t, decltype(floats)> wholes;
  const hn::Rebind<std::uint16_t, decltype(floats)> words;
  const hn::Rebind<std::uint8_t, decltype(floats)> bytes;
  const auto units = hn::Set(floats, units_a_half), one = hn::Set(floats, 1.0F);
  for (std::size_t i = 0; i < count; i += hn::Lanes(floats)) {
    const auto root = hn::Sqrt(hn::ConvertTo(floats, hn::PromoteTo(wholes, hn::LoadU(words, squared + i))));
    const auto number = hn::ConvertTo(wholes, hn::Add(hn::Mul(units, root), one));  // towards zero
    hn::StoreU(hn::DemoteTo(bytes, number), bytes, out + i);
  }
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {

void number_bytes(const std::uint16_t* squared, std::size_t count, int units,
                  [[maybe_unused]] InstructionSet vectors, std::uint8_t* out) {
  const float units_a_half = 0.5F * static_cast<float>(units);
#if HWY_ARCH_X86
  if (vectors == InstructionSet::avx512) return N_AVX3::number_all(squared, count, units_a_half, out);
  if (vectors == InstructionSet::avx2) return N_AVX2::number_all(squared, count, units_a_half, out);
#endif
  HWY_STATIC_DISPATCH(number_all)(squared, count, units_a_half, out);
}

}  // namespace clearway
#endif
