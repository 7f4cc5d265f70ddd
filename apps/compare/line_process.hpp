#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "mapping/system/file_descriptor.hpp"

namespace clearway {

/// A program that ended because it may take no more memory.
class ProgramOutOfMemory : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A program of somebody else that reads lines and answers with lines. It runs under `sh`, in a process group
/// of its own, and dies with the thread that started it; both ends of its talk are one socket. What it writes
/// to its standard error is kept for the sentence that says how it ended.
class LineProcess {
 public:
  /// @throws std::runtime_error when no process can be started.
  explicit LineProcess(const std::string& command);
  ~LineProcess();  ///< ends it and whatever it started
  LineProcess(const LineProcess&) = delete;
  LineProcess& operator=(const LineProcess&) = delete;

  /// Sends a line and waits for one; none when `is_late()` says so, which is asked some hundred times a
  /// second. @throws std::runtime_error when the program ends, closes its output or answers with too much;
  /// ProgramOutOfMemory when it ends for want of memory where that is limited, as it is in an isolated run.
  std::optional<std::string> ask(std::string_view line, const std::function<bool()>& is_late);

  /// A line that is there and that nobody asked for. @throws as ask
  std::optional<std::string> unasked();

  /// That the program took so far, but not others that it started. Where the shell stays, because the command
  /// is more than a program and its arguments, of all that it started and that run.
  double cpu_seconds() const;

 private:
  void send_some(std::string_view& rest);
  void receive_some();
  std::optional<std::string> take_line();
  void hear_complaints();
  [[noreturn]] void fail(const std::string& what);

  pid_t process_ = -1;
  bool is_under_shell_ = false;
  FileDescriptor talk_, complaints_;
  std::string received_, last_words_;
};

}  // namespace clearway
