#include "mapping/system/number_text.hpp"

#include <charconv>

namespace clearway {

std::string to_text(double value) {
  char buffer[40];
  return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

std::string to_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + to_text(value);
  return text;
}

std::string short_text(double value) {
  char buffer[40];
  return std::string(buffer,
                     std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 4).ptr);
}

}  // namespace clearway
