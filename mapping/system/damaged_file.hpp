#pragma once

#include <stdexcept>

namespace clearway {

/// A file that exists and can be opened, but whose content is broken; the message says what and where.
class DamagedFile : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace clearway
