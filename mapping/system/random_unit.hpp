#pragma once

#include <random>

namespace clearway {

/// In [0, 1), the same on every machine (std::uniform_real_distribution is not).
inline double random_unit(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

}  // namespace clearway
