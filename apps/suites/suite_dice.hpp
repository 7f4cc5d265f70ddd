#pragma once

#include <numbers>

#include "datasets/descriptions/random_numbers.hpp"

namespace clearway {

inline constexpr double degree = std::numbers::pi / 180.0;

/// Random numbers one after the other, the same on every machine. Streams of one seed are independent.
class SuiteDice {
 public:
  SuiteDice(std::uint64_t seed, std::uint64_t stream) : random_(seed, stream) {}

  double between(double low, double high) { return low + (high - low) * random_.uniform(next_++); }
  int whole(int low, int high) { return low + static_cast<int>(between(0.0, high - low + 1.0)); }

 private:
  RandomNumbers random_;
  std::uint64_t next_ = 0;
};

}  // namespace clearway
