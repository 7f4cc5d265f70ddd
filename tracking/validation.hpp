#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// @throws std::invalid_argument "<what> must be <expected>" unless it holds.
inline void require(bool holds, const std::string& what, const char* expected) {
  if (!holds) throw std::invalid_argument(what + " must be " + expected);
}

}  // namespace clearway
