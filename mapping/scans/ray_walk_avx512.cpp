// Sixteen rays in lockstep with AVX-512: the choices and sums of walk_ray, eight rays to a register.

#include "mapping/scans/ray_window.hpp"

#ifdef __x86_64__
#include <immintrin.h>

// g++ 12 takes the "undefined" sources of its own intrinsics for a mistake (bug 105593).
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

namespace clearway {
namespace {

struct Eight {
  __m512d next[3], delta[3];
  __m512i step[3], at;
};

__attribute__((target("avx512f,avx512dq"))) inline void load(const RayPack& pack, std::size_t lane,
                                                             Eight& rays) {
  for (std::size_t i = 0; i < 3; ++i) {
    rays.next[i] = _mm512_load_pd(pack.next[i] + lane);
    rays.delta[i] = _mm512_load_pd(pack.delta[i] + lane);
    rays.step[i] = _mm512_load_si512(pack.step[i] + lane);
  }
  rays.at = _mm512_load_si512(pack.at + lane);
}

/// One cell on: along z when its border is not beyond the others, else along y, else along x.
__attribute__((target("avx512f,avx512dq"))) inline void advance(Eight& r) {
  const __mmask8 z = _mm512_cmp_pd_mask(r.next[2], _mm512_min_pd(r.next[0], r.next[1]), _CMP_LE_OQ);
  const __mmask8 not_z = _knot_mask8(z);
  const __mmask8 y = _mm512_mask_cmp_pd_mask(not_z, r.next[1], r.next[0], _CMP_LE_OQ);
  const __mmask8 x = _mm512_mask_cmp_pd_mask(not_z, r.next[1], r.next[0], _CMP_GT_OQ);
  r.next[0] = _mm512_mask_add_pd(r.next[0], x, r.next[0], r.delta[0]);
  r.next[1] = _mm512_mask_add_pd(r.next[1], y, r.next[1], r.delta[1]);
  r.next[2] = _mm512_mask_add_pd(r.next[2], z, r.next[2], r.delta[2]);
  r.at = _mm512_mask_add_epi64(r.at, x, r.at, r.step[0]);
  r.at = _mm512_mask_add_epi64(r.at, y, r.at, r.step[1]);
  r.at = _mm512_mask_add_epi64(r.at, z, r.at, r.step[2]);
}

/// Lanes whose ray ends where it is: in its last cell, or in a cell that it leaves beyond its reach.
__attribute__((target("avx512f,avx512dq"))) inline unsigned ended(const Eight& r, const RayPack& pack,
                                                                  std::size_t lane) {
  const __m512d leaves = _mm512_min_pd(_mm512_min_pd(r.next[0], r.next[1]), r.next[2]);
  const __mmask8 beyond = _mm512_cmp_pd_mask(leaves, _mm512_load_pd(pack.reach + lane), _CMP_GT_OQ);
  return beyond | _mm512_cmpeq_epi64_mask(r.at, _mm512_load_si512(pack.end + lane));
}

/// Lets lanes stand still in the origin's cell.
__attribute__((target("avx512f,avx512dq"))) inline void halt(Eight& r, unsigned lanes, std::int64_t origin) {
  const auto idle = static_cast<__mmask8>(lanes);
  for (std::size_t i = 0; i < 3; ++i) {
    r.delta[i] = _mm512_mask_mov_pd(r.delta[i], idle, _mm512_setzero_pd());
    r.step[i] = _mm512_mask_mov_epi64(r.step[i], idle, _mm512_setzero_si512());
  }
  r.at = _mm512_mask_mov_epi64(r.at, idle, _mm512_set1_epi64(origin));
}

__attribute__((target("avx512f,avx512dq"))) inline std::int64_t least_safe(const RayPack& pack,
                                                                           unsigned active) {
  const auto low = static_cast<__mmask8>(active & 0xffU), high = static_cast<__mmask8>(active >> 8U);
  const __m512i most = _mm512_set1_epi64(std::int64_t{1} << 40U);
  const __m512i a = _mm512_mask_mov_epi64(most, low, _mm512_load_si512(pack.safe));
  const __m512i b = _mm512_mask_mov_epi64(most, high, _mm512_load_si512(pack.safe + 8));
  return _mm512_reduce_min_epi64(_mm512_min_epi64(a, b));
}

/// Through registers: loads from memory that was just written wait for the stores of earlier marks.
__attribute__((target("avx512f,avx512dq"))) inline void mark_four(__m256i at, std::uint8_t* cells) {
  const __m128i low = _mm256_castsi256_si128(at), high = _mm256_extracti128_si256(at, 1);
  cells[_mm_cvtsi128_si64(low)] = 1;
  cells[_mm_extract_epi64(low, 1)] = 1;
  cells[_mm_cvtsi128_si64(high)] = 1;
  cells[_mm_extract_epi64(high, 1)] = 1;
}

__attribute__((target("avx512f,avx512dq"))) inline void mark(const Eight& r, std::uint8_t* cells) {
  mark_four(_mm512_castsi512_si256(r.at), cells);
  mark_four(_mm512_extracti64x4_epi64(r.at, 1), cells);
}

}  // namespace

__attribute__((target("avx512f,avx512dq"))) void walk_pack_avx512(RayPack& pack, std::uint8_t* cells) {
  Eight a, b;
  load(pack, 0, a);
  load(pack, 8, b);
  unsigned active = pack.active;
  std::int64_t done = 0;
  while (active != 0) {
    for (const std::int64_t safe = least_safe(pack, active); done < safe; ++done) {
      advance(a);
      advance(b);
      mark(a, cells);
      mark(b, cells);
    }
    unsigned halted = 0;
    while (halted == 0) {
      advance(a);
      advance(b);
      ++done;
      halted = (ended(a, pack, 0) | ended(b, pack, 8) << 8U) & active;
      if (halted != 0) {
        halt(a, halted & 0xffU, pack.origin);
        halt(b, halted >> 8U, pack.origin);
      }
      mark(a, cells);
      mark(b, cells);
    }
    active &= ~halted;
  }
}

}  // namespace clearway
#endif
