// Look-ups of four points at once with AVX2.

#include "mapping/field/field_look_up.hpp"

#ifdef __x86_64__
#include <immintrin.h>

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#include "mapping/field/field_look_up_kernel.hpp"

namespace clearway {
namespace {

struct Four {
  typedef double Numbers __attribute__((vector_size(32)));
  typedef int Wholes __attribute__((vector_size(16)));
  typedef long long Addresses __attribute__((vector_size(32)));

  static Numbers load(const double* from) { return _mm256_loadu_pd(from); }
  static void store(double* to, const Numbers& numbers) { _mm256_storeu_pd(to, numbers); }
  static Numbers sqrt(const Numbers& numbers) { return _mm256_sqrt_pd(numbers); }
  static Addresses gather_addresses(const void* from, const Wholes& index) {
    return reinterpret_cast<Addresses>(
        _mm256_mask_i32gather_epi64(_mm256_setzero_si256(), static_cast<const long long*>(from),
                                    reinterpret_cast<__m128i>(index), _mm256_set1_epi64x(-1), 8));
  }
  static Wholes gather_pairs(const Addresses& at) {
    return reinterpret_cast<Wholes>(_mm256_mask_i64gather_epi32(
        _mm_setzero_si128(), nullptr, reinterpret_cast<__m256i>(at), _mm_set1_epi32(-1), 1));
  }
  static Numbers gather_numbers(const double* from, const Wholes& index) {
    const __m256d all = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
    return _mm256_mask_i32gather_pd(Numbers{}, from, reinterpret_cast<__m128i>(index), all, 8);
  }
};

}  // namespace

void coarse_clearances_avx2(const FieldLookUp& field, const FieldPoints& points, double* out) {
  LookUp<Four>(field).coarse(points, out);
}
void clearances_avx2(const FieldLookUp& field, const FieldPoints& points, double* out) {
  LookUp<Four>(field).tight(points, out);
}

}  // namespace clearway
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
