// Distances of four cubes at once with AVX2.

#include "planning/geometry/voxel_distance_lanes.hpp"

#ifdef __x86_64__
#include <immintrin.h>

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#include "planning/geometry/voxel_distance_kernel.hpp"

namespace clearway {
namespace {

struct Four {
  typedef double Numbers __attribute__((vector_size(32)));
  using Truths = decltype(Numbers{} < Numbers{});
  static constexpr int width = 4;

  static Numbers all(double value) { return _mm256_set1_pd(value); }
  static Numbers load(const double* from) { return _mm256_loadu_pd(from); }
  static void store(double* to, const Numbers& numbers) { _mm256_storeu_pd(to, numbers); }
  static Numbers root(const Numbers& numbers) { return _mm256_sqrt_pd(numbers); }
  static Numbers select(const Truths& truths, const Numbers& a, const Numbers& b) {
    return _mm256_blendv_pd(b, a, reinterpret_cast<__m256d>(truths));
  }
  static bool any(const Truths& truths) { return _mm256_movemask_pd(reinterpret_cast<__m256d>(truths)) != 0; }
};

}  // namespace

void voxel_distances_avx2(DistanceKind kind, const DistanceBody& body, DistanceLanes& lanes) {
  DistanceKernel<Four>(body).run(kind, lanes);
}

}  // namespace clearway
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
