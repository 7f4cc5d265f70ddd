#pragma once

#include <stdexcept>
#include <string>

#include "mapping/free_space_map.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {

/// @throws std::invalid_argument naming the option of a map unless low <= value <= high; NaN is refused, too.
inline void check_map_option(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;  // false for NaN
  throw std::invalid_argument(std::string("map option ") + name + " is " + short_text(value) +
                              ", expected a value in [" + short_text(low, 6) + ", " + short_text(high, 6) +
                              "]");
}

/// The options that say how scans are inserted. @throws as check_map_option
inline void check_insertion_options(const MapOptions& options) {
  check_map_option("hit_probability", options.hit_probability, 0.5, 0.999999);
  check_map_option("miss_probability", options.miss_probability, 1e-6, 0.5);
  check_map_option("threads", options.threads, 1, 64);
  check_map_option("margins.band", options.margins.band, 0.0, 100.0);
  check_map_option("margins.sigmas", options.margins.sigmas, 0.0, 100.0);
  check_map_option("margins.noise_constant", options.margins.noise_constant, 0.0, 100.0);
  check_map_option("margins.noise_quadratic", options.margins.noise_quadratic, 0.0, 100.0);
  check_map_option("margins.noise_limit", options.margins.noise_limit, 0.0, 100.0);
  check_map_option("margins.most_called_free", options.margins.most_called_free, 0.0, 1.0);
}

}  // namespace clearway
