#include "mapping/system/number_text.hpp"

#include <charconv>
#include <cmath>

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

std::string short_text(double value) { return short_text(value, 4); }

std::string short_text(double value, int digits) {
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits);
  return std::string(buffer, end.ptr);
}

std::string text_beside(double value, double limit) {
  int digits = 6;
  while (digits < 17 && value != limit && short_text(value, digits) == short_text(limit, digits)) ++digits;
  return short_text(value, digits);
}

std::string place_text(double metres) {
  int digits = 4;
  for (double reach = 10.0; digits < 17 && std::abs(metres) >= reach; reach *= 10.0) ++digits;
  return short_text(metres, digits);
}

std::string grouped(std::size_t number) {
  std::string digits = std::to_string(number);
  for (int i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3)
    digits.insert(static_cast<std::size_t>(i), 1, ',');
  return digits;
}

std::string counted(std::size_t count, const std::string& one) { return counted(count, one, one + "s"); }

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return grouped(count) + " " + (count == 1 ? one : many);
}

}  // namespace clearway
