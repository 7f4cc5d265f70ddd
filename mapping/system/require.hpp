#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// @throws std::invalid_argument with the sentence unless it holds.
inline void require(bool holds, const std::string& sentence) {
  if (!holds) throw std::invalid_argument(sentence);
}

}  // namespace clearway
