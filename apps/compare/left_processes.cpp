#include "apps/compare/left_processes.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string>

namespace clearway {
namespace {

std::set<pid_t> children() {
  std::ifstream file("/proc/self/task/" + std::to_string(::getpid()) + "/children");
  std::set<pid_t> found;
  for (pid_t child = 0; file >> child;) found.insert(child);
  return found;
}

}  // namespace

LeftProcesses::LeftProcesses() : own_(children()) { ::prctl(PR_SET_CHILD_SUBREAPER, 1); }

/// Each that ends leaves its own to this process before it can be waited for.
LeftProcesses::~LeftProcesses() {
  for (bool found = true; found;) {
    found = false;
    for (const pid_t child : children()) {
      if (own_.contains(child)) continue;
      if (::kill(child, SIGKILL) != 0) {  // of another user: it would be waited for as long as it lives
        own_.insert(child);
        continue;
      }
      found = true;
      while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
  }
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);
}

}  // namespace clearway
