#include "mapping/field/distance_axes.hpp"

#include <algorithm>
#include <cstring>

namespace clearway {
namespace {

// Vector registers of 16, 32 and 64 bytes; the compiler splits none of them under the target that uses it.
template <class Number, int Bytes>
struct VectorOf {
  typedef Number type __attribute__((vector_size(Bytes), may_alias, aligned(sizeof(Number))));
};

/// True when any number of `a` exceeds the one beside it in `b`.
template <int Bytes>
inline __attribute__((always_inline)) bool any_above(const typename VectorOf<std::uint16_t, Bytes>::type& a,
                                                     std::uint16_t b) {
  using Words = typename VectorOf<std::uint64_t, Bytes>::type;
  const Words over = reinterpret_cast<Words>(a > b);
  std::uint64_t any = 0;
  for (int i = 0; i < Bytes / 8; ++i) any |= over[i];
  return any != 0;
}

template <int Bytes>
inline __attribute__((always_inline)) void lower_body(const std::uint16_t* center, std::ptrdiff_t stride,
                                                      const std::uint16_t* gaps, int nearest, int window,
                                                      std::uint16_t* out) {
  using Vector = typename VectorOf<std::uint16_t, Bytes>::type;
  constexpr int width = Bytes / 2;
  for (int part = 0; part < lane_cells; part += width) {
    const std::uint16_t* at = center + part;
    Vector best = *reinterpret_cast<const Vector*>(at);
    for (int steps = nearest; steps <= window && any_above<Bytes>(best, gaps[steps]); steps += 4) {
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) {
        const std::ptrdiff_t away = (steps + i) * stride;
        const Vector low = *reinterpret_cast<const Vector*>(at - away);
        const Vector high = *reinterpret_cast<const Vector*>(at + away);
        const Vector sum = (low < high ? low : high) + gaps[steps + i];
        best = sum < best ? sum : best;
      }
    }
    *reinterpret_cast<Vector*>(out + part) = best;
  }
}

template <int Bytes>
inline __attribute__((always_inline)) bool above_body(const std::uint16_t* numbers, std::uint16_t limit) {
  using Vector = typename VectorOf<std::uint16_t, Bytes>::type;
  for (int part = 0; part < lane_cells; part += Bytes / 2) {
    if (any_above<Bytes>(*reinterpret_cast<const Vector*>(numbers + part), limit)) return true;
  }
  return false;
}

/// 0xff for each set bit of a byte.
constexpr std::array<std::uint64_t, 256> make_spread() {
  std::array<std::uint64_t, 256> spread{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      if ((byte >> bit & 1U) != 0) spread[byte] |= std::uint64_t{0xff} << (8 * bit);
    }
  }
  return spread;
}
constexpr std::array<std::uint64_t, 256> spread_bits = make_spread();

/// Two sweeps along the axis, all lines side by side: one step more than the cell before, 0 where a bit is
/// set.
template <int Width>
inline __attribute__((always_inline)) void count_body(const std::uint32_t* words, int lines, int count,
                                                      int window, std::uint8_t* steps) {
  using Bytes = typename VectorOf<std::uint8_t, Width>::type;
  const Bytes far = Bytes{} + static_cast<std::uint8_t>(window + 1);
  const std::ptrdiff_t row = std::ptrdiff_t{lines} * lane_cells;
  for (int i = 0; i < count; ++i) {
    std::uint8_t* now = steps + i * row;
    for (int line = 0; line < lines; ++line, ++words, now += lane_cells) {
      std::uint64_t blocked[4] = {};
      if (*words != 0) {
        for (int byte = 0; byte < 4; ++byte) blocked[byte] = spread_bits[*words >> (8 * byte) & 0xffU];
      }
      for (int part = 0; part < lane_cells; part += Width) {
        Bytes next = far;
        if (i > 0) next = *reinterpret_cast<const Bytes*>(now - row + part) + std::uint8_t{1};
        next = next < far ? next : far;
        next &= ~*reinterpret_cast<const Bytes*>(reinterpret_cast<const std::uint8_t*>(blocked) + part);
        *reinterpret_cast<Bytes*>(now + part) = next;
      }
    }
  }
  for (int i = count - 2; i >= 0; --i) {
    std::uint8_t* now = steps + i * row;
    for (std::ptrdiff_t k = 0; k < row; k += Width) {
      const Bytes back = *reinterpret_cast<const Bytes*>(now + row + k) + std::uint8_t{1};
      const Bytes best = *reinterpret_cast<const Bytes*>(now + k);
      *reinterpret_cast<Bytes*>(now + k) = best < back ? best : back;
    }
  }
}

template <int Width>
inline __attribute__((always_inline)) void square_body(const std::uint8_t* steps, int window,
                                                       std::uint16_t cap, std::uint16_t* squared) {
  using Bytes = typename VectorOf<std::uint8_t, Width / 2>::type;
  using Numbers = typename VectorOf<std::uint16_t, Width>::type;
  const Numbers far = Numbers{} + static_cast<std::uint16_t>(window);
  const Numbers most = Numbers{} + cap;
  for (int part = 0; part < lane_cells; part += Width / 2) {
    const Numbers count = __builtin_convertvector(*reinterpret_cast<const Bytes*>(steps + part), Numbers);
    const Numbers odd = count + count - (count > 0 ? Numbers{} + std::uint16_t{1} : Numbers{});
    *reinterpret_cast<Numbers*>(squared + part) = count > far ? most : odd * odd;
  }
}

bool above_portable(const std::uint16_t* numbers, std::uint16_t limit) {
  return above_body<16>(numbers, limit);
}
void lower_portable(const std::uint16_t* center, std::ptrdiff_t stride, const std::uint16_t* gaps,
                    int nearest, int window, std::uint16_t* out) {
  lower_body<16>(center, stride, gaps, nearest, window, out);
}
void count_portable(const std::uint32_t* words, int lines, int count, int window, std::uint8_t* steps) {
  count_body<16>(words, lines, count, window, steps);
}
void square_portable(const std::uint8_t* steps, int window, std::uint16_t cap, std::uint16_t* squared) {
  square_body<16>(steps, window, cap, squared);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) bool above_avx2(const std::uint16_t* numbers, std::uint16_t limit) {
  return above_body<32>(numbers, limit);
}
__attribute__((target("avx2"))) void lower_avx2(const std::uint16_t* center, std::ptrdiff_t stride,
                                                const std::uint16_t* gaps, int nearest, int window,
                                                std::uint16_t* out) {
  lower_body<32>(center, stride, gaps, nearest, window, out);
}
__attribute__((target("avx2"))) void count_avx2(const std::uint32_t* words, int lines, int count, int window,
                                                std::uint8_t* steps) {
  count_body<32>(words, lines, count, window, steps);
}
__attribute__((target("avx2"))) void square_avx2(const std::uint8_t* steps, int window, std::uint16_t cap,
                                                 std::uint16_t* squared) {
  square_body<32>(steps, window, cap, squared);
}
__attribute__((target("avx512bw"))) bool above_avx512(const std::uint16_t* numbers, std::uint16_t limit) {
  return above_body<64>(numbers, limit);
}
__attribute__((target("avx512bw"))) void lower_avx512(const std::uint16_t* center, std::ptrdiff_t stride,
                                                      const std::uint16_t* gaps, int nearest, int window,
                                                      std::uint16_t* out) {
  lower_body<64>(center, stride, gaps, nearest, window, out);
}
#endif

}  // namespace

DistanceAxes::DistanceAxes(std::uint16_t cap, InstructionSet vectors)
    : cap_(cap),
      window_(0),
      lower_(lower_portable),
      above_(above_portable),
      count_(count_portable),
      square_(square_portable) {
  while (gap_squared(window_ + 1) < cap) ++window_;
  for (int steps = 0; steps <= window_ + unroll; ++steps) {
    gaps_.push_back(static_cast<std::uint16_t>(std::min(gap_squared(steps), int{cap})));
  }
#if defined(__x86_64__) && defined(__GNUC__)
  if (vectors == InstructionSet::portable) return;
  lower_ = vectors == InstructionSet::avx2 ? lower_avx2 : lower_avx512;
  above_ = vectors == InstructionSet::avx2 ? above_avx2 : above_avx512;
  count_ = count_avx2;
  square_ = square_avx2;
#else
  static_cast<void>(vectors);
#endif
}

void DistanceAxes::count_steps(const std::uint32_t* words, int lines, int count, std::uint8_t* steps) const {
  count_(words, lines, count, window_, steps);
}

bool DistanceAxes::square_steps(const std::uint8_t* steps, std::uint16_t* squared) const {
  std::uint64_t words[lane_cells / 8];
  std::memcpy(words, steps, sizeof words);
  const std::uint64_t far = 0x0101010101010101ULL * static_cast<std::uint64_t>(window_ + 1);
  if (((words[0] ^ far) | (words[1] ^ far) | (words[2] ^ far) | (words[3] ^ far)) == 0) {
    std::fill_n(squared, lane_cells, cap_);
    return false;
  }
  square_(steps, window_, cap_, squared);
  return true;
}

}  // namespace clearway
