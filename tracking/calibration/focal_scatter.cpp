#include "tracking/calibration/focal_scatter.hpp"

#include <cmath>

#include "tracking/pose_errors.hpp"

namespace clearway {

FocalScatter focal_scatter(const std::vector<BundleFit::FocalStep>& steps) {
  double weights = 0.0, squared_weights = 0.0, sum = 0.0, squares = 0.0;
  int told = 0;
  for (const BundleFit::FocalStep& step : steps) {
    if (!std::isfinite(step.sigma)) continue;
    const double weight = 1.0 / (step.sigma * step.sigma);
    weights += weight;
    squared_weights += weight * weight;
    sum += weight * step.off;
    squares += weight * step.off * step.off;
    ++told;
  }
  if (told < 2) return {};
  const double q = squares - sum * sum / weights;
  const double freedom = told - 1;
  const auto limit = [freedom](double normal_quantile) {  // Wilson and Hilferty 1931
    const double ninth = 2.0 / (9.0 * freedom);
    return freedom * std::pow(1.0 - ninth + normal_quantile * std::sqrt(ninth), 3.0);
  };
  if (q < limit(1.645)) return {};
  return {std::sqrt((q - freedom) / (weights - squared_weights / weights)), q > limit(2.326),
          q > chi_square_limit(told - 1)};
}

}  // namespace clearway
