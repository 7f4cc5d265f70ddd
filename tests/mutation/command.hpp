#pragma once

#include <filesystem>
#include <string>

namespace clearway::mutation {

/// How a program ended.
struct Ended {
  int exit = -1;         ///< status; -1: a signal ended it
  int signal = 0;        ///< 0: none
  bool is_late = false;  ///< it ran past a limit
  double cpu = 0.0;      ///< s, of it and of what it waited for
  std::string output;    ///< stdout and stderr

  bool is_good() const { return exit == 0 && !is_late; }
};

struct Limits {
  double cpu = 600.0, wall = 3600.0;   ///< s
  std::uint64_t memory = 8ULL << 30U;  ///< bytes of address space; 0: any
};

/// Runs a shell command in a folder, with TMPDIR there, and ends it and what it started at its limits.
Ended run_command(const std::string& command, const std::filesystem::path& folder, const Limits& limits);

}  // namespace clearway::mutation
