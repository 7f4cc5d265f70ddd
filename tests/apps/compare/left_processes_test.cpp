#include "apps/compare/left_processes.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace clearway {
namespace left_processes_test {

/// A child that ends at once and leaves one of its own, `depth` generations down, which sleeps; its number.
pid_t leave_one_behind(int depth, bool in_other_group) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    for (int i = 1; i < depth; ++i)
      if (::fork() != 0) ::_exit(0);
    const pid_t left = ::fork();
    if (left == 0) {
      if (in_other_group) ::setsid();
      ::close(ends[1]);
      ::sleep(600);
      ::_exit(0);
    }
    const ssize_t written = ::write(ends[1], &left, sizeof left);
    ::_exit(written == sizeof left ? 0 : 1);
  }
  ::close(ends[1]);
  pid_t left = 0;
  EXPECT_EQ(::read(ends[0], &left, sizeof left), static_cast<ssize_t>(sizeof left));
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return left;
}

bool is_there(pid_t process) { return ::kill(process, 0) == 0 || errno != ESRCH; }

TEST(LeftProcesses, WhatARunLeftIsKilledWhateverItsGroupAndItsGeneration) {
  const pid_t mine = ::fork();  // one that this process has already
  if (mine == 0) {
    ::sleep(600);
    ::_exit(0);
  }
  for (const bool in_other_group : {false, true}) {
    for (const int depth : {1, 2, 4}) {
      pid_t left = 0;
      {
        const LeftProcesses guard;
        left = leave_one_behind(depth, in_other_group);
        EXPECT_TRUE(is_there(left));
      }
      EXPECT_FALSE(is_there(left)) << depth << in_other_group;
    }
  }
  EXPECT_TRUE(is_there(mine));
  ::kill(mine, SIGKILL);
  ::waitpid(mine, nullptr, 0);
}

}  // namespace left_processes_test
}  // namespace clearway
