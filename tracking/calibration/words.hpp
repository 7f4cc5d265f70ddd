#pragma once

#include <locale>
#include <sstream>
#include <string>

namespace clearway {

/// Texts and numbers in one text, numbers with three digits and a point in every locale.
template <typename... Parts>
std::string words(const Parts&... parts) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(3);
  (text << ... << parts);
  return text.str();
}

}  // namespace clearway
