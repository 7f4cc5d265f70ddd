#include <algorithm>
#include <cmath>

#include "mapping/scans/ray_window.hpp"

#ifdef __x86_64__
#include <immintrin.h>

// g++ 12 takes the "undefined" sources of its own intrinsics for a mistake (bug 105593).
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace clearway {
namespace {

/// A ray is safe for as many steps as it has borders to cross within its reach, less 7: 3 for the fractions
/// that are counted in, 3 for rounding (one border an axis at most), and one more.
constexpr double unsafe_steps = 7.0;

void fill_lane(const RayStarter& starter, const RayWindow& window, const RayEnd& end, std::size_t lane,
               RayPack& pack) {
  const RayState ray = starter.start(end);
  double crossings = -unsafe_steps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    pack.next[axis][lane] = ray.next[axis];
    pack.delta[axis][lane] = ray.delta[axis];
    pack.step[axis][lane] = ray.step[axis] * window.stride(axis);
    if (ray.reach >= ray.next[axis]) crossings += 1.0 + (ray.reach - ray.next[axis]) / ray.delta[axis];
  }
  pack.at[lane] = pack.origin;
  pack.end[lane] = window.index(ray.end);
  pack.reach[lane] = ray.reach;
  const int steps = (ray.end - ray.cell).cwiseAbs().sum();
  pack.safe[lane] = crossings > 0.0 ? static_cast<std::int64_t>(std::min(crossings, steps - 1.0)) : 0;
  pack.active |= 1U << lane;
}

void fill_portable(const RayStarter& starter, const RayWindow& window, const RayEnd* rays, RayPack& pack) {
  for (std::size_t lane = 0; lane < RayPack::size; ++lane) {
    if (starter.cell(rays[lane].point) != starter.origin_cell()) {
      fill_lane(starter, window, rays[lane], lane, pack);
      continue;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      pack.next[axis][lane] = pack.delta[axis][lane] = 0.0;
      pack.step[axis][lane] = 0;
    }
    pack.at[lane] = pack.end[lane] = pack.origin;
    pack.reach[lane] = 0.0;
    pack.safe[lane] = 0;
  }
}

#ifdef __x86_64__
/// RayStarter::start for eight rays at once, the same operations in the same precision.
__attribute__((target("avx512f,avx512dq,avx512vl"))) void fill_eight(const RayStarter& starter,
                                                                     const RayWindow& window,
                                                                     const RayEnd* rays, std::size_t lane,
                                                                     RayPack& pack) {
  static_assert(sizeof(RayEnd) == 16);
  const __m256i offsets = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
  const float* const first = rays->point.data();
  __m256 point[3], way[3];
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = _mm256_i32gather_ps(first + axis, offsets, 4);
    way[axis] = _mm256_sub_ps(point[axis], _mm256_set1_ps(starter.origin()[axis]));
  }
  const __m256 squared =
      _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(way[0], way[0]), _mm256_mul_ps(way[1], way[1])),
                    _mm256_mul_ps(way[2], way[2]));
  const __m256 length = _mm512_cvtpd_ps(_mm512_sqrt_pd(_mm512_cvtps_pd(squared)));
  const __m512d reach = _mm512_cvtps_pd(_mm256_min_ps(_mm256_i32gather_ps(first + 3, offsets, 4), length));

  const __m512d most = _mm512_set1_pd(std::numeric_limits<double>::max());
  __m512d crossings = _mm512_set1_pd(-unsafe_steps), steps = _mm512_set1_pd(-1.0);
  __m512d end = _mm512_set1_pd(static_cast<double>(pack.origin));
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    const __m512d cell =
        _mm512_roundscale_pd(_mm512_mul_pd(_mm512_set1_pd(starter.factor()), _mm512_cvtps_pd(point[i])),
                             _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
    const __m512d cells = _mm512_sub_pd(cell, _mm512_set1_pd(starter.origin_cell()[axis]));
    const auto stride = static_cast<double>(window.stride(i));
    end = _mm512_add_pd(end, _mm512_mul_pd(cells, _mm512_set1_pd(stride)));
    steps = _mm512_add_pd(steps, _mm512_abs_pd(cells));

    const __m512d direction = _mm512_cvtps_pd(_mm256_div_ps(way[i], length));
    const __mmask8 forward = _mm512_cmp_pd_mask(direction, _mm512_setzero_pd(), _CMP_GT_OQ);
    const __mmask8 moves = _mm512_cmp_pd_mask(direction, _mm512_setzero_pd(), _CMP_LT_OQ) | forward;
    const __m512d border = _mm512_mask_blend_pd(forward, _mm512_set1_pd(starter.to_border(i, 0)),
                                                _mm512_set1_pd(starter.to_border(i, 1)));
    const __m512d size = _mm512_abs_pd(direction);
    const __m512d next = _mm512_mask_div_pd(most, moves, border, direction);
    const __m512d delta = _mm512_mask_div_pd(most, moves, _mm512_set1_pd(starter.resolution()), size);
    const __m512d left = _mm512_mul_pd(_mm512_sub_pd(reach, next), size);
    const __m512d here =
        _mm512_add_pd(_mm512_set1_pd(1.0), _mm512_mul_pd(left, _mm512_set1_pd(starter.factor())));
    crossings =
        _mm512_mask_add_pd(crossings, moves & _mm512_cmp_pd_mask(reach, next, _CMP_GE_OQ), crossings, here);
    const __m512i stride_back = _mm512_set1_epi64(-window.stride(i));
    const __m512i step = _mm512_mask_mov_epi64(stride_back, forward, _mm512_set1_epi64(window.stride(i)));
    _mm512_store_pd(pack.next[i] + lane, next);
    _mm512_store_pd(pack.delta[i] + lane, delta);
    _mm512_store_si512(pack.step[i] + lane, _mm512_maskz_mov_epi64(moves, step));
  }
  _mm512_store_si512(pack.at + lane, _mm512_set1_epi64(pack.origin));
  _mm512_store_si512(pack.end + lane, _mm512_cvttpd_epi64(end));
  _mm512_store_pd(pack.reach + lane, reach);
  const __m512d safe = _mm512_max_pd(_mm512_min_pd(steps, crossings), _mm512_setzero_pd());  // 0 for NaN
  _mm512_store_si512(pack.safe + lane, _mm512_cvttpd_epi64(safe));
  const __mmask8 active = _mm512_cmp_pd_mask(steps, _mm512_setzero_pd(), _CMP_GE_OQ);
  pack.active |= static_cast<unsigned>(active) << lane;
  for (auto& step : pack.step)  // the others stay where they are
    _mm512_mask_store_epi64(step + lane, static_cast<__mmask8>(~active), _mm512_setzero_si512());
}
#endif

}  // namespace

void fill_pack(const RayStarter& starter, const RayWindow& window,
               const std::array<RayEnd, RayPack::size>& rays, InstructionSet set, RayPack& pack) {
  pack.active = 0;
  pack.origin = window.index(starter.origin_cell());
#ifdef __x86_64__
  if (set == InstructionSet::avx512) {
    fill_eight(starter, window, rays.data(), 0, pack);
    fill_eight(starter, window, rays.data() + 8, 8, pack);
    return;
  }
#endif
  (void)set;
  fill_portable(starter, window, rays.data(), pack);
}

}  // namespace clearway
