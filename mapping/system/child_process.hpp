#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// What a child process may take.
struct ChildLimits {
  std::size_t memory = 0;  ///< address space beyond what the program has already, bytes
  std::size_t output = 0;  ///< bytes that the parent accepts
  int seconds = 10;        ///< processor time, and wall clock
  int kept = -1;           ///< a descriptor from 3 on that the child keeps, besides its own
  int patience = 1;  ///< of the wall clock so many times the seconds: others may keep the processor busy
};

/// How a child process ended.
struct ChildOutcome {
  bool finished = false;           ///< `work` returned and its whole output arrived
  std::vector<std::string> parts;  ///< of the output; when it did not finish: those that arrived whole
  std::string failure;             ///< otherwise: why, in a few words
  int status = 0;                  ///< how the process ended, as waitpid has it
  bool is_late = false;            ///< it was ended because its seconds were over
  bool is_out_of_memory = false;   ///< `work` let std::bad_alloc through
};

/// Takes a part of the output out of the child.
using SendPart = std::function<void(std::string_view)>;
using PartedWork = std::function<void(const SendPart&)>;

/// Runs `work` in a forked copy of this program and collects the parts that it sends. For parsers that
/// crash, hang or eat memory on hostile files: they take only the child down. The child is silent, has none
/// of the parent's open files and signal handlers, can write no file, and dies with the parent. It must not
/// wait for other threads of the parent: they are not in it. An exception's text becomes `failure`.
/// @throws std::runtime_error when no process can be started.
ChildOutcome run_in_child(const PartedWork& work, const ChildLimits& limits);

/// The same for work whose one part is the text that it returns.
ChildOutcome run_in_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace clearway
