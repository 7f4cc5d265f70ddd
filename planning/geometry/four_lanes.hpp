#pragma once

// Not part of the installed library: four numbers side by side, the same operations in the same order, and so
// the same bits, on every machine.

#include <cmath>
#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace clearway::lanes {

using Pair = double __attribute__((vector_size(16)));  // of any x86-64, and of 64-bit ARM
using PlacePair = std::int64_t __attribute__((vector_size(16)));

constexpr int width = 4;
struct Numbers {
  Pair low{}, high{};
  double operator[](int lane) const { return lane < 2 ? low[lane] : high[lane - 2]; }
  void set(int lane, double value) {
    if (lane < 2)
      low[lane] = value;
    else
      high[lane - 2] = value;  // one assignment to either is GNU's alone
  }
};
struct Places {
  PlacePair low{}, high{};
  std::int64_t operator[](int lane) const { return lane < 2 ? low[lane] : high[lane - 2]; }
};

inline Numbers operator+(const Numbers& a, const Numbers& b) { return {a.low + b.low, a.high + b.high}; }
inline Numbers operator-(const Numbers& a, const Numbers& b) { return {a.low - b.low, a.high - b.high}; }
inline Numbers operator*(const Numbers& a, const Numbers& b) { return {a.low * b.low, a.high * b.high}; }
inline Numbers operator*(double a, const Numbers& b) { return {a * b.low, a * b.high}; }
inline Numbers operator/(const Numbers& a, const Numbers& b) { return {a.low / b.low, a.high / b.high}; }
inline Numbers operator-(const Numbers& a) { return {-a.low, -a.high}; }
inline Numbers all(double value) { return {Pair{value, value}, Pair{value, value}}; }
inline Numbers absolute(const Numbers& a) {
  return {a.low < 0.0 ? -a.low : a.low, a.high < 0.0 ? -a.high : a.high};
}

/// Truths of the lanes: all bits or none.
inline Places operator&(const Places& a, const Places& b) { return {a.low & b.low, a.high & b.high}; }
inline Places operator~(const Places& a) { return {~a.low, ~a.high}; }
inline Places operator<(const Numbers& a, const Numbers& b) { return {a.low < b.low, a.high < b.high}; }
inline Places operator<=(const Numbers& a, const Numbers& b) { return {a.low <= b.low, a.high <= b.high}; }
inline Places operator==(const Numbers& a, const Numbers& b) { return {a.low == b.low, a.high == b.high}; }
inline Numbers select(const Places& truth, const Numbers& a, const Numbers& b) {
  return {truth.low ? a.low : b.low, truth.high ? a.high : b.high};
}
inline Numbers larger(const Numbers& a, const Numbers& b) { return select(a < b, b, a); }
inline Numbers smaller(const Numbers& a, const Numbers& b) { return select(b < a, b, a); }
inline bool any(const Places& truth) {
  const PlacePair both = truth.low | truth.high;
  return (both[0] | both[1]) != 0;
}
inline Pair root(const Pair& a) {
#ifdef __SSE2__
  return _mm_sqrt_pd(a);
#else
  return {std::sqrt(a[0]), std::sqrt(a[1])};
#endif
}
inline Numbers root(const Numbers& a) { return {root(a.low), root(a.high)}; }

/// n rounded up to whole lanes: vectors are padded with zeros to this length.
constexpr int padded(int n) { return (n + width - 1) / width * width; }

inline Numbers load(const double* from) {
  Numbers numbers;
  std::memcpy(&numbers.low, from, sizeof numbers.low);
  std::memcpy(&numbers.high, from + 2, sizeof numbers.high);
  return numbers;
}

inline void store(double* to, const Numbers& numbers) {
  std::memcpy(to, &numbers.low, sizeof numbers.low);
  std::memcpy(to + 2, &numbers.high, sizeof numbers.high);
}

/// The smallest number of each lane so far, and the place where it was seen first.
struct LeastSoFar {
  Numbers least;
  Places where;
  void look_at(const Numbers& numbers, std::int64_t place) {
    look_at(numbers.low, PlacePair{place, place + 1}, least.low, where.low);
    look_at(numbers.high, PlacePair{place + 2, place + 3}, least.high, where.high);
  }

 private:
  static void look_at(const Pair& numbers, const PlacePair& places, Pair& least, PlacePair& where) {
    const PlacePair is_less = numbers < least;
    least = is_less ? numbers : least;
    where = is_less ? places : where;
  }
};

/// @pre the lengths are whole lanes.
inline double dot(const double* a, const double* b, int length) {
  Numbers sum;
  for (int j = 0; j < length; j += width) sum = sum + load(a + j) * load(b + j);
  const Pair halves = sum.low + sum.high;
  return halves[0] + halves[1];
}

/// a -= factor b
inline void take_off(double* a, double factor, const double* b, int length) {
  for (int j = 0; j < length; j += width) store(a + j, load(a + j) - factor * load(b + j));
}

}  // namespace clearway::lanes
