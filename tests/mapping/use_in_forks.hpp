#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <thread>

namespace clearway {

/// Calls `use` in 100 forked processes, one after the other, while another thread calls it over and over. How
/// many ended well; the first that does not, within 20 s, is the last.
template <class Use>
int use_in_forks(const Use& use) {
  std::atomic<bool> done = false;
  std::thread other([&] {
    while (!done) use();
  });
  int ended = 0;
  for (int i = 0; i < 100 && ended == i; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::alarm(20);
      use();
      ::_exit(0);
    }
    int status = -1;
    if (::waitpid(child, &status, 0) == child && status == 0) ++ended;
  }
  done = true;
  other.join();
  return ended;
}

}  // namespace clearway
