#include "apps/console/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway {

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double last = static_cast<double>(values.size() - 1), at = std::clamp(p * last, 0.0, last);
  const double below = values[static_cast<std::size_t>(at)];
  const double above = values[static_cast<std::size_t>(std::ceil(at))];
  return above == below ? below : below + (at - std::floor(at)) * (above - below);
}

}  // namespace clearway
