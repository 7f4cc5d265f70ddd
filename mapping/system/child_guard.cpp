#include "mapping/system/child_guard.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <locale>
#include <utility>
#include <vector>

namespace clearway {
namespace {

void limit(__rlimit_resource resource, rlim_t value) {
  // One apart: at the hard limit of time comes a SIGKILL, which does not say what it is for.
  const rlimit bound{value, value + 1};
  ::setrlimit(resource, &bound);
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CLEARWAY_SANITIZED
#endif
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(CLEARWAY_SANITIZED)
void limit_memory(std::size_t) {}  // sanitizers reserve terabytes
#else
void limit_memory(std::size_t beyond_present) {
  std::ifstream statm("/proc/self/statm");
  statm.imbue(std::locale::classic());
  std::size_t pages = 0;
  statm >> pages;
  limit(RLIMIT_AS, pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + beyond_present);
}
#endif

void close_all_but(std::vector<int> kept) {
  std::sort(kept.begin(), kept.end());
  unsigned first = 3;
  for (const int descriptor : kept) {
    const auto number = static_cast<unsigned>(descriptor);
    if (number > first) ::close_range(first, number - 1, 0);
    first = std::max(first, number + 1);
  }
  ::close_range(first, ~0U, 0);
}

void let_go_of_handlers() {
  for (int number = 1; number < NSIG; ++number) {
    struct sigaction now {};
    // What the parent ignores, as SIGHUP under nohup, stays ignored.
    if (::sigaction(number, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) ::signal(number, SIG_DFL);
  }
  ::signal(SIGPIPE, SIG_IGN);
}

}  // namespace

void leave_parent(std::initializer_list<int*> kept, pid_t parent, int nowhere) {
  if (parent != 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(0);  // it went before the line above
  }
  let_go_of_handlers();
  std::vector<int> numbers;
  for (int* descriptor : kept) {
    if (*descriptor < 3) *descriptor = ::fcntl(*descriptor, F_DUPFD_CLOEXEC, 3);
    if (*descriptor < 0) ::_exit(0);
    numbers.push_back(*descriptor);
  }
  if (nowhere < 0) nowhere = ::open("/dev/null", O_RDWR);
  for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
  close_all_but(std::move(numbers));
}

void guard_child(std::initializer_list<int*> kept, const ChildGuard& guard) {
  leave_parent(kept, guard.parent);
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  ::setrlimit(RLIMIT_FSIZE, &none);
  limit(RLIMIT_CPU, static_cast<rlim_t>(guard.seconds));
  limit_memory(guard.memory);
}

bool write_fully(int descriptor, const void* from, std::size_t size) {
  const char* next = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t written = ::write(descriptor, next, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    next += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace clearway
