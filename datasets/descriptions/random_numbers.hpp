#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace clearway {

/// Random numbers by counter: the value depends on (seed, stream, counter) alone, so pixels may be computed
/// in any order and on any machine (the standard library's distributions are not portable).
class RandomNumbers {
 public:
  RandomNumbers(uint64_t seed, uint64_t stream) : key_(mix(mix(seed + golden) ^ (stream * golden))) {}

  uint64_t bits(uint64_t counter) const { return mix(key_ + golden * (counter + 1)); }

  /// Uniform in (0, 1), never an end.
  double uniform(uint64_t counter) const {
    return (static_cast<double>(bits(counter) >> 11) + 0.5) * 0x1p-53;
  }

  /// Two independent standard normal numbers (Box-Muller), from counters 2 `pair` and 2 `pair` + 1.
  struct Pair {
    double first, second;
  };
  Pair gaussian(uint64_t pair) const {
    const double radius = std::sqrt(-2 * std::log(uniform(2 * pair)));
    const double angle = 2 * std::numbers::pi * uniform(2 * pair + 1);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  static constexpr uint64_t golden = 0x9e3779b97f4a7c15;
  /// The finaliser of splitmix64.
  static uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  uint64_t key_;
};

}  // namespace clearway
