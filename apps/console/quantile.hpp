#pragma once

#include <vector>

namespace clearway {

/// The p-th quantile (0 to 1) by nearest rank; NaN of no values.
double quantile(std::vector<double> values, double p);

}  // namespace clearway
