#pragma once

#include <string>
#include <vector>

#include "apps/console/console.hpp"

namespace clearway {

/// Runs `clearway ARGUMENTS...` (without the program's name) and returns the exit status: 0 done, 1 the
/// answer is no, 2 usage or bad input (one sentence on the log), 3 damaged input. Tests call it in-process.
int run_command_line(const std::vector<std::string>& arguments, Console& console);

}  // namespace clearway
