#pragma once

#include <cmath>
#include <cstdlib>
#include <string_view>

namespace clearway {

/// How often a test with drawn cases draws: `few` times in `./check`, which takes minutes, `many` times where
/// CLEARWAY_TRIALS is "many", as in `./check --full`.
inline int trials(int few, int many) {
  const char* asked = std::getenv("CLEARWAY_TRIALS");
  return asked != nullptr && std::string_view(asked) == "many" ? many : few;
}

/// What a chi-square of `degrees` of freedom exceeds once in a thousand (Wilson and Hilferty 1931; within 1 %
/// from 10 degrees on).
inline double chi_square_of_a_thousand(int degrees) {
  const double part = 2.0 / (9.0 * degrees);
  return degrees * std::pow(1.0 - part + 3.0902 * std::sqrt(part), 3);
}

}  // namespace clearway
