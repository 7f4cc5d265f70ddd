#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace clearway {

/// The number that a whole text is, in any locale; nothing for another text, infinity and NaN.
inline std::optional<double> finite_number(const std::string& text) {
  double value = 0.0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

}  // namespace clearway
