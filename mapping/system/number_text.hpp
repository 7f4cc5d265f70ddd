#pragma once

#include <string>
#include <vector>

namespace clearway {

/// Numbers as options print them: the shortest text that reads back to the same double.
std::string to_text(double value);
std::string to_text(const std::vector<double>& values);  ///< comma-separated
std::string short_text(double value);                    ///< four digits, for sentences
std::string short_text(double value, int digits);        ///< so many significant digits, >= 1

}  // namespace clearway
