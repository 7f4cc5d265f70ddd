#include "mapping/distance_transform.hpp"

#include <algorithm>
#include <array>

namespace clearway {
namespace {

constexpr int lane = DistanceBlock::lane;
using Lane = std::array<std::uint16_t, lane>;

/// Squared distance along one axis, in half voxels, from a cell's centre to the cube `steps` cells away.
constexpr int gap_squared(int steps) { return steps == 0 ? 0 : (2 * steps - 1) * (2 * steps - 1); }

/// Cells on either side of a line that can matter: beyond them a gap alone reaches the cap.
int window_of(int cap) {
  int steps = 0;
  while (gap_squared(steps + 1) < cap) ++steps;
  return steps;
}

/// Along x the input holds only 0 and cap: the nearest blocked cell to the left and to the right is enough.
void transform_row(std::uint16_t* row, int nx, int cap, int window) {
  const int far = window + 1;
  int steps = far;
  const auto squared = [&](int gap) {
    return static_cast<std::uint16_t>(gap < far ? gap_squared(gap) : cap);
  };
  for (int x = 0; x < nx; ++x) {
    steps = row[x] == 0 ? 0 : std::min(steps + 1, far);
    row[x] = squared(steps);
  }
  steps = far;
  for (int x = nx - 1; x >= 0; --x) {
    steps = row[x] == 0 ? 0 : std::min(steps + 1, far);
    row[x] = std::min(row[x], squared(steps));
  }
}

/// One line of lanes: out[i] = min over |d| <= window of in[i + d] + gap_squared(d). Lanes that are `cap`
/// everywhere cannot lower anything and are skipped.
inline __attribute__((always_inline)) void transform_line_body(const Lane* in, const std::uint8_t* useful,
                                                               Lane* out, int count, int window) {
  for (int i = 0; i < count; ++i) {
    Lane best = in[i];
    const int first = std::max(0, i - window);
    const int last = std::min(count - 1, i + window);
    for (int j = first; j <= last; ++j) {
      if (useful[j] == 0 || j == i) continue;
      const auto gap = static_cast<std::uint16_t>(gap_squared(j < i ? i - j : j - i));
      const Lane& from = in[j];
      for (int k = 0; k < lane; ++k) {
        const auto sum = static_cast<std::uint16_t>(from[k] + gap);
        best[k] = sum < best[k] ? sum : best[k];
      }
    }
    out[i] = best;
  }
}

// Integers only, so every instruction set gives the same field.
#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) void transform_line_avx2(const Lane* in, const std::uint8_t* useful,
                                                         Lane* out, int count, int window) {
  transform_line_body(in, useful, out, count, window);
}
bool has_avx2() { return __builtin_cpu_supports("avx2") != 0; }
#else
void transform_line_avx2(const Lane* in, const std::uint8_t* useful, Lane* out, int count, int window) {
  transform_line_body(in, useful, out, count, window);
}
bool has_avx2() { return false; }
#endif

void transform_line(const Lane* in, const std::uint8_t* useful, Lane* out, int count, int window) {
  static const bool wide = has_avx2();
  if (wide) return transform_line_avx2(in, useful, out, count, window);
  transform_line_body(in, useful, out, count, window);
}

/// Transforms the `count` lanes that start at `start` and lie `step` cells apart.
struct LineTransform {
  explicit LineTransform(int count)
      : in(static_cast<std::size_t>(count)),
        out(static_cast<std::size_t>(count)),
        useful(static_cast<std::size_t>(count)) {}

  void run(std::uint16_t* start, std::size_t step, std::uint16_t cap, int window) {
    bool any = false;
    for (std::size_t i = 0; i < in.size(); ++i) {
      std::copy_n(start + i * step, lane, in[i].data());
      useful[i] = std::any_of(in[i].begin(), in[i].end(), [cap](std::uint16_t v) { return v < cap; }) ? 1 : 0;
      any = any || useful[i] != 0;
    }
    if (!any) return;
    transform_line(in.data(), useful.data(), out.data(), static_cast<int>(in.size()), window);
    for (std::size_t i = 0; i < out.size(); ++i) std::copy_n(out[i].data(), lane, start + i * step);
  }

  std::vector<Lane> in, out;
  std::vector<std::uint8_t> useful;
};

}  // namespace

DistanceBlock::DistanceBlock(int x, int y, int z, std::uint16_t truncation)
    : nx(x), ny(y), nz(z), stride((x + lane - 1) / lane * lane), cap(truncation) {
  squared.assign(
      static_cast<std::size_t>(stride) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), cap);
}

void transform_distances(DistanceBlock& block) {
  const int window = window_of(block.cap);
  const auto row = static_cast<std::size_t>(block.stride);
  const std::size_t slice = row * static_cast<std::size_t>(block.ny);
  for (int z = 0; z < block.nz; ++z) {
    for (int y = 0; y < block.ny; ++y) {
      transform_row(&block.squared[block.index(0, y, z)], block.nx, block.cap, window);
    }
  }
  LineTransform along_y(block.ny);
  for (int z = 0; z < block.nz; ++z) {
    for (int x = 0; x < block.stride; x += lane) {
      along_y.run(&block.squared[block.index(x, 0, z)], row, block.cap, window);
    }
  }
  LineTransform along_z(block.nz);
  for (int y = 0; y < block.ny; ++y) {
    for (int x = 0; x < block.stride; x += lane) {
      along_z.run(&block.squared[block.index(x, y, 0)], slice, block.cap, window);
    }
  }
}

}  // namespace clearway
