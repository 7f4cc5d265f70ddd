#pragma once

#include <sys/types.h>

#include <set>

namespace clearway {

/// Ends what a run leaves behind: processes that an external planner started and did not end. While one
/// lives, they come to this process when their parent ends (PR_SET_CHILD_SUBREAPER); at its end they are
/// killed and waited for. For a process of one thread, whose own children are those that it has at the
/// beginning.
class LeftProcesses {
 public:
  LeftProcesses();
  ~LeftProcesses();
  LeftProcesses(const LeftProcesses&) = delete;
  LeftProcesses& operator=(const LeftProcesses&) = delete;

 private:
  std::set<pid_t> own_;
};

}  // namespace clearway
