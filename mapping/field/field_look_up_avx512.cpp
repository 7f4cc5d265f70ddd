// Look-ups of eight points at once with AVX-512.

#include "mapping/field/field_look_up.hpp"

#ifdef __x86_64__
#include <immintrin.h>

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,avx512bw"))), \
                             apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw")
#endif
#include "mapping/field/field_look_up_kernel.hpp"

namespace clearway {
namespace {

struct Eight {
  typedef double Numbers __attribute__((vector_size(64)));
  typedef int Wholes __attribute__((vector_size(32)));
  typedef long long Addresses __attribute__((vector_size(64)));

  static Numbers load(const double* from) { return _mm512_loadu_pd(from); }
  static void store(double* to, const Numbers& numbers) { _mm512_storeu_pd(to, numbers); }
  static Numbers sqrt(const Numbers& numbers) { return _mm512_maskz_sqrt_pd(0xff, numbers); }
  static Addresses gather_addresses(const void* from, const Wholes& index) {
    return reinterpret_cast<Addresses>(
        _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), 0xff, reinterpret_cast<__m256i>(index), from, 8));
  }
  static Wholes gather_pairs(const Addresses& at) {
    return reinterpret_cast<Wholes>(
        _mm512_mask_i64gather_epi32(_mm256_setzero_si256(), 0xff, reinterpret_cast<__m512i>(at), nullptr, 1));
  }
  static Numbers gather_numbers(const double* from, const Wholes& index) {
    return _mm512_mask_i32gather_pd(Numbers{}, 0xff, reinterpret_cast<__m256i>(index), from, 8);
  }
};

}  // namespace

void coarse_clearances_avx512(const FieldLookUp& field, const FieldPoints& points, double* out) {
  LookUp<Eight>(field).coarse(points, out);
}
void clearances_avx512(const FieldLookUp& field, const FieldPoints& points, double* out) {
  LookUp<Eight>(field).tight(points, out);
}

}  // namespace clearway
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
