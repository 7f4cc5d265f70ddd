// Sixteen rays in lockstep with AVX2: the choices and sums of walk_ray, four rays to a register.

#include "mapping/scans/ray_window.hpp"

#ifdef __x86_64__
#include <immintrin.h>

#include <algorithm>

namespace clearway {
namespace {

constexpr std::size_t width = 4;

struct Four {
  __m256d next[3], delta[3];
  __m256i step[3], at;
};

__attribute__((target("avx2"))) inline void load(const RayPack& pack, std::size_t lane, Four& rays) {
  for (std::size_t i = 0; i < 3; ++i) {
    rays.next[i] = _mm256_load_pd(pack.next[i] + lane);
    rays.delta[i] = _mm256_load_pd(pack.delta[i] + lane);
    rays.step[i] = _mm256_load_si256(reinterpret_cast<const __m256i*>(pack.step[i] + lane));
  }
  rays.at = _mm256_load_si256(reinterpret_cast<const __m256i*>(pack.at + lane));
}

/// One cell on: along z when its border is not beyond the others, else along y, else along x. Adding 0 where
/// an axis is not chosen changes nothing.
__attribute__((target("avx2"))) inline void advance(Four& r) {
  const __m256d z = _mm256_cmp_pd(r.next[2], _mm256_min_pd(r.next[0], r.next[1]), _CMP_LE_OQ);
  const __m256d before = _mm256_cmp_pd(r.next[1], r.next[0], _CMP_LE_OQ);
  const __m256d y = _mm256_andnot_pd(z, before);
  const __m256d ones = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
  const __m256d x = _mm256_andnot_pd(_mm256_or_pd(z, before), ones);
  const __m256d chosen[3] = {x, y, z};
  for (std::size_t i = 0; i < 3; ++i) {
    r.next[i] = _mm256_add_pd(r.next[i], _mm256_and_pd(chosen[i], r.delta[i]));
    r.at = _mm256_add_epi64(r.at, _mm256_and_si256(_mm256_castpd_si256(chosen[i]), r.step[i]));
  }
}

/// Lanes whose ray ends where it is: in its last cell, or in a cell that it leaves beyond its reach.
__attribute__((target("avx2"))) inline unsigned ended(const Four& r, const RayPack& pack, std::size_t lane) {
  const __m256d leaves = _mm256_min_pd(_mm256_min_pd(r.next[0], r.next[1]), r.next[2]);
  const __m256d beyond = _mm256_cmp_pd(leaves, _mm256_load_pd(pack.reach + lane), _CMP_GT_OQ);
  const __m256i there =
      _mm256_cmpeq_epi64(r.at, _mm256_load_si256(reinterpret_cast<const __m256i*>(pack.end + lane)));
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_or_pd(beyond, _mm256_castsi256_pd(there))));
}

__attribute__((target("avx2"))) inline void mark(const Four& r, std::uint8_t* cells) {
  alignas(32) std::int64_t at[width];
  _mm256_store_si256(reinterpret_cast<__m256i*>(at), r.at);
  for (const std::int64_t cell : at) cells[cell] = 1;
}

/// Walks four rays until none is active.
__attribute__((target("avx2"))) void walk_four(RayPack& pack, std::size_t lane, std::uint8_t* cells) {
  unsigned active = pack.active >> lane & 0xfU;
  Four rays;
  load(pack, lane, rays);
  std::int64_t done = 0;
  while (active != 0) {
    std::int64_t safe = std::int64_t{1} << 40U;
    for (std::size_t i = 0; i < width; ++i)
      if ((active >> i & 1U) != 0) safe = std::min(safe, pack.safe[lane + i]);
    for (; done < safe; ++done) {
      advance(rays);
      mark(rays, cells);
    }
    advance(rays);
    ++done;
    const unsigned halted = ended(rays, pack, lane) & active;
    if (halted != 0) {  // these stand still in the origin's cell
      alignas(32) std::int64_t idle[width];
      for (std::size_t i = 0; i < width; ++i) idle[i] = (halted >> i & 1U) != 0 ? -1 : 0;
      const __m256i gone = _mm256_load_si256(reinterpret_cast<const __m256i*>(idle));
      for (std::size_t i = 0; i < 3; ++i) {
        rays.delta[i] = _mm256_andnot_pd(_mm256_castsi256_pd(gone), rays.delta[i]);
        rays.step[i] = _mm256_andnot_si256(gone, rays.step[i]);
      }
      rays.at = _mm256_blendv_epi8(rays.at, _mm256_set1_epi64x(pack.origin), gone);
      active &= ~halted;
    }
    mark(rays, cells);
  }
}

}  // namespace

__attribute__((target("avx2"))) void walk_pack_avx2(RayPack& pack, std::uint8_t* cells) {
  for (std::size_t lane = 0; lane < RayPack::size; lane += width) walk_four(pack, lane, cells);
}

}  // namespace clearway
#endif
