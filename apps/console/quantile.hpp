#pragma once

#include <vector>

namespace clearway {

/// The p-th quantile (0 to 1), linear between the two values next to it (type 7 of Hyndman and Fan 1996, Am.
/// Stat. 50, p. 361, the default of NumPy and R): at 0.5 the median, of an even number of values the mean of
/// the two in the middle. NaN of no values.
double quantile(std::vector<double> values, double p);

}  // namespace clearway
