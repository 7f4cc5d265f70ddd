#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace clearway {

/// Numbers as options print them: the shortest text that reads back to the same double.
std::string to_text(double value);
std::string to_text(const std::vector<double>& values);  ///< comma-separated
std::string short_text(double value);                    ///< four digits, for sentences
std::string short_text(double value, int digits);        ///< so many significant digits, >= 1
/// A value beside a limit, for sentences: six digits, and as many more as tell it from the limit.
std::string text_beside(double value, double limit);
/// A coordinate in metres, for sentences: four digits, and to the millimetre however far it is.
std::string place_text(double metres);

/// "1234567" as "1,234,567".
std::string grouped(std::size_t number);

/// "1 run", "2,000 runs". @param many where it is not `one` with an s
std::string counted(std::size_t count, const std::string& one);
std::string counted(std::size_t count, const std::string& one, const std::string& many);

}  // namespace clearway
