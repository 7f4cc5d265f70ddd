#pragma once

#include <exception>
#include <string>

#include "apps/console/console.hpp"

namespace clearway {

/// How a command that could not do its work ends.
struct Failure {
  std::string sentence;  ///< one line, plain, without the program's name
  ExitStatus status = exit_bad_input;
};

/// The only place where exceptions become words. Our own carry their sentence. Those of libraries and of the
/// language (an allocation that failed, parsers' internals) get one of ours: what they say helps nobody who
/// did not write the program.
Failure failure_of(const std::exception_ptr& error);

}  // namespace clearway
