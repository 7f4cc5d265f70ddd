#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// What the call throws as std::invalid_argument; empty when it does not.
template <class Call>
std::string complaint(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

}  // namespace clearway
