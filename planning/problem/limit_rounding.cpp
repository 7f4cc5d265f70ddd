#include "planning/problem/limit_rounding.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {

double drawn_to_limit(const Joint& joint, double value) {
  constexpr double single = 4e-7, least = 1e-9, most = 1e-6;
  const double limit = std::clamp(value, joint.lower, joint.upper);
  const double rounding = std::clamp(single * std::abs(limit), least, most);
  return std::abs(value - limit) <= rounding ? limit : value;
}

}  // namespace clearway
