#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace clearway {

/// The median of the values, of an even number of them the larger of the two in the middle. @pre not empty
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace clearway
