#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// @throws std::invalid_argument naming the option of a map unless low <= value <= high; NaN is refused, too.
inline void check_map_option(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;  // false for NaN
  throw std::invalid_argument(std::string("map option ") + name + " is " + std::to_string(value) +
                              ", expected a value in [" + std::to_string(low) + ", " + std::to_string(high) +
                              "]");
}

}  // namespace clearway
