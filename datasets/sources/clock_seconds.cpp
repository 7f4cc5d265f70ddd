#include "datasets/sources/clock_seconds.hpp"

#include <algorithm>
#include <utility>

namespace clearway {

void make_seconds(std::vector<double>& times) {
  const double largest = times.empty() ? 0.0 : *std::max_element(times.begin(), times.end());
  for (const auto& [from, unit] : {std::pair{1e12, 1e-3}, std::pair{1e15, 1e-6}, std::pair{1e18, 1e-9}})
    if (largest >= from && largest < 10.0 * from)
      for (double& time : times) time *= unit;
}

}  // namespace clearway
