// Distances of eight cubes at once with AVX-512.

#include "planning/geometry/voxel_distance_lanes.hpp"

#ifdef __x86_64__
#include <immintrin.h>

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,avx512bw"))), \
                             apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw")
#endif
#include "planning/geometry/voxel_distance_kernel.hpp"

namespace clearway {
namespace {

/// One bit for each lane, as these registers compare.
struct Truths {
  __mmask8 bits;
};
struct Numbers {
  double v __attribute__((vector_size(64)));
};

[[gnu::always_inline]] inline Truths operator&(Truths a, Truths b) {
  return {static_cast<__mmask8>(a.bits & b.bits)};
}
[[gnu::always_inline]] inline Truths operator~(Truths a) { return {static_cast<__mmask8>(~a.bits)}; }
[[gnu::always_inline]] inline Numbers operator+(const Numbers& a, const Numbers& b) { return {a.v + b.v}; }
[[gnu::always_inline]] inline Numbers operator-(const Numbers& a, const Numbers& b) { return {a.v - b.v}; }
[[gnu::always_inline]] inline Numbers operator*(const Numbers& a, const Numbers& b) { return {a.v * b.v}; }
[[gnu::always_inline]] inline Numbers operator*(double a, const Numbers& b) { return {a * b.v}; }
[[gnu::always_inline]] inline Numbers operator/(const Numbers& a, const Numbers& b) { return {a.v / b.v}; }
[[gnu::always_inline]] inline Numbers operator-(const Numbers& a) { return {-a.v}; }
[[gnu::always_inline]] inline Truths operator<(const Numbers& a, const Numbers& b) {
  return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OS)};
}
[[gnu::always_inline]] inline Truths operator<=(const Numbers& a, const Numbers& b) {
  return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OS)};
}
[[gnu::always_inline]] inline Truths operator==(const Numbers& a, const Numbers& b) {
  return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_EQ_OQ)};
}

struct Eight {
  using Numbers = clearway::Numbers;
  static constexpr int width = 8;

  static Numbers all(double value) { return {_mm512_set1_pd(value)}; }
  static Numbers load(const double* from) { return {_mm512_loadu_pd(from)}; }
  static void store(double* to, const Numbers& numbers) { _mm512_storeu_pd(to, numbers.v); }
  static Numbers root(const Numbers& numbers) { return {_mm512_maskz_sqrt_pd(0xff, numbers.v)}; }
  static Numbers select(Truths truths, const Numbers& a, const Numbers& b) {
    return {_mm512_mask_blend_pd(truths.bits, b.v, a.v)};
  }
  static bool any(Truths truths) { return truths.bits != 0; }
};

}  // namespace

void voxel_distances_avx512(DistanceKind kind, const DistanceBody& body, DistanceLanes& lanes) {
  DistanceKernel<Eight>(body).run(kind, lanes);
}

}  // namespace clearway
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
