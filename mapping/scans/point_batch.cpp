#include "mapping/scans/point_batch.hpp"

#include <cmath>

#ifdef __x86_64__
#include <immintrin.h>

// g++ 12 takes the "undefined" sources of its own intrinsics for a mistake (bug 105593).
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace clearway {
namespace {

constexpr double lowest_cell = -32768.0, highest_cell = 32767.0;

void place_portable(const Eigen::Vector3f* points, std::size_t count,
                    const Eigen::Isometry3d& map_from_sensor, double factor, PointBatch& batch) {
  batch.finite = batch.has_cell = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d placed = map_from_sensor * points[i].cast<double>();
    const Eigen::Vector3f stored = placed.cast<float>();
    batch.x[i] = stored.x();
    batch.y[i] = stored.y();
    batch.z[i] = stored.z();
    if (!stored.allFinite()) continue;
    batch.finite |= 1U << i;
    const Eigen::Array3d cell = (factor * stored.cast<double>()).array().floor();
    if ((cell < lowest_cell).any() || (cell > highest_cell).any()) continue;
    batch.has_cell |= 1U << i;
    batch.cell_x[i] = static_cast<int>(cell.x());
    batch.cell_y[i] = static_cast<int>(cell.y());
    batch.cell_z[i] = static_cast<int>(cell.z());
  }
}

#ifdef __x86_64__
/// Eight points; lanes without a point are not finite.
__attribute__((target("avx512f,avx512dq,avx512vl"))) void place_eight(const Eigen::Vector3f* points,
                                                                      std::size_t count,
                                                                      const Eigen::Matrix<double, 3, 4>& pose,
                                                                      double factor, std::size_t lane,
                                                                      PointBatch& batch) {
  const __m256i offsets = _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21);
  const auto given = static_cast<__mmask8>((1U << std::min<std::size_t>(count, 8)) - 1U);
  const __m256 nothing = _mm256_set1_ps(std::nanf(""));
  const float* const first = points->data();
  __m512d sensor[3];
  for (int axis = 0; axis < 3; ++axis)
    sensor[axis] = _mm512_cvtps_pd(_mm256_mmask_i32gather_ps(nothing, given, offsets, first + axis, 4));
  float* const stored[3] = {batch.x.data() + lane, batch.y.data() + lane, batch.z.data() + lane};
  std::int32_t* const cells[3] = {batch.cell_x.data() + lane, batch.cell_y.data() + lane,
                                  batch.cell_z.data() + lane};
  __mmask8 finite = 0xff, inside = 0xff;
  for (int axis = 0; axis < 3; ++axis) {  // the order of Eigen's sums
    __m512d sum = _mm512_mul_pd(_mm512_set1_pd(pose(axis, 0)), sensor[0]);
    sum = _mm512_add_pd(sum, _mm512_mul_pd(_mm512_set1_pd(pose(axis, 1)), sensor[1]));
    sum = _mm512_add_pd(sum, _mm512_mul_pd(_mm512_set1_pd(pose(axis, 2)), sensor[2]));
    const __m256 placed = _mm512_cvtpd_ps(_mm512_add_pd(_mm512_set1_pd(pose(axis, 3)), sum));
    _mm256_store_ps(stored[axis], placed);
    const __m512d exact = _mm512_cvtps_pd(placed);
    const __m512d magnitude = _mm512_abs_pd(exact);
    finite &= _mm512_cmp_pd_mask(magnitude, _mm512_set1_pd(HUGE_VAL), _CMP_LT_OQ);
    const __m512d cell = _mm512_roundscale_pd(_mm512_mul_pd(_mm512_set1_pd(factor), exact),
                                              _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
    inside &= _mm512_cmp_pd_mask(cell, _mm512_set1_pd(lowest_cell), _CMP_GE_OQ) &
              _mm512_cmp_pd_mask(cell, _mm512_set1_pd(highest_cell), _CMP_LE_OQ);
    _mm256_store_si256(reinterpret_cast<__m256i*>(cells[axis]), _mm512_cvttpd_epi32(cell));
  }
  batch.finite |= static_cast<unsigned>(finite) << lane;
  batch.has_cell |= static_cast<unsigned>(finite & inside) << lane;
}
#endif

}  // namespace

void place_points(const Eigen::Vector3f* points, std::size_t count, const Eigen::Isometry3d& map_from_sensor,
                  double factor, InstructionSet set, PointBatch& batch) {
#ifdef __x86_64__
  if (set == InstructionSet::avx512) {
    const Eigen::Matrix<double, 3, 4> pose = map_from_sensor.matrix().topRows<3>();
    batch.finite = batch.has_cell = 0;
    place_eight(points, count, pose, factor, 0, batch);
    if (count > 8) place_eight(points + 8, count - 8, pose, factor, 8, batch);
    return;
  }
#endif
  (void)set;
  place_portable(points, count, map_from_sensor, factor, batch);
}

}  // namespace clearway
