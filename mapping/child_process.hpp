#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace clearway {

/// What a child process may take.
struct ChildLimits {
  std::size_t memory = 0;  ///< address space beyond what the program has already, bytes
  std::size_t output = 0;  ///< bytes that the parent accepts
  int seconds = 10;        ///< wall clock
};

/// How a child process ended.
struct ChildOutcome {
  bool finished = false;  ///< `work` returned and its whole output arrived
  std::string output;
  std::string failure;  ///< otherwise: why, in a few words
};

/// Runs `work` in a forked copy of this program, silenced, and returns the text that it returns. For parsers
/// that crash, hang or eat memory on hostile files: they take only the child down. An exception's text
/// becomes `failure`.
/// @throws std::runtime_error when no process can be started.
ChildOutcome run_in_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace clearway
