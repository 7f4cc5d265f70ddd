#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// What the call throws as this error; empty when it does not.
template <class Error = std::invalid_argument, class Call>
std::string complaint(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace clearway
