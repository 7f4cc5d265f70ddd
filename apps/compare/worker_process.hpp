#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/system/file_descriptor.hpp"

namespace clearway {

/// A forked copy of this program that answers requests, one after the other: what it prepares stays with it,
/// and when it crashes it takes nobody else down. Requests and replies are bytes of any kind. The worker is
/// silent, has none of the program's open files and signal handlers, and dies with the thread that made it.
/// To be made while no other thread runs that could hold a lock: none of them is in the copy.
class WorkerProcess {
 public:
  using Reply = std::function<void(std::string_view)>;
  /// Called in the worker for each request. It must not throw.
  using Serve = std::function<void(std::string_view request, const Reply& reply)>;

  /// @throws std::runtime_error when no process can be started.
  explicit WorkerProcess(const Serve& serve);
  ~WorkerProcess();  ///< ends the worker, whatever it does
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// Sends a request, which the worker reads when it has answered the ones before; nothing when it is dead.
  void ask(std::string_view request);

  /// Readable, as poll() has it, when replies() would find something, or the worker's end.
  int descriptor() const { return replies_.number(); }
  /// What arrived whole. Waits for the next bytes when none are there.
  std::vector<std::string> replies();
  /// replies() found the worker's end.
  bool has_ended() const { return has_ended_; }
  /// "ended by SIGSEGV"; to be asked after its end, once.
  std::string how_it_ended();

 private:
  FileDescriptor requests_, replies_;
  pid_t process_ = -1;
  std::string received_;
  bool has_ended_ = false;
};

/// "ended by SIGSEGV" or "ended with status 3": a process, from what waitpid says.
std::string end_of_process(int status);

}  // namespace clearway
