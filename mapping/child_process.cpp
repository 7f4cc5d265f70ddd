#include "mapping/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace clearway {
namespace {

// The first byte that a child sends tells what the rest is.
constexpr char result_mark = 'R', failure_mark = 'F', end_mark = 'E';

void limit(__rlimit_resource resource, rlim_t value) {
  const rlimit bound{value, value};
  ::setrlimit(resource, &bound);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
void limit_memory(std::size_t) {}  // sanitizers reserve terabytes
#else
void limit_memory(std::size_t beyond_present) {
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  statm >> pages;
  limit(RLIMIT_AS, pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + beyond_present);
}
#endif

bool send(int pipe, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(pipe, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

[[noreturn]] void run_child(int pipe, const std::function<std::string()>& work, const ChildLimits& limits) {
  for (int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) ::signal(number, SIG_DFL);
  ::signal(SIGPIPE, SIG_IGN);
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(limits.seconds));
  limit_memory(limits.memory);
  bool sent = false;
  try {
    const std::string output = work();
    sent = send(pipe, {&result_mark, 1}) && send(pipe, output);
  } catch (const std::exception& error) {
    sent = send(pipe, {&failure_mark, 1}) && send(pipe, error.what());
  } catch (...) {
    sent = false;
  }
  if (sent) send(pipe, {&end_mark, 1});
  ::_exit(0);
}

/// Reads until the child closes its end; returns why it stopped earlier, or "".
std::string receive(int pipe, const ChildLimits& limits, std::string& received) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(limits.seconds);
  std::array<char, 65536> buffer{};
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return "it took longer than " + std::to_string(limits.seconds) + " s";
    pollfd waiting{pipe, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
    const ssize_t count = ::read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return "";
    received.append(buffer.data(), static_cast<std::size_t>(count));
    if (received.size() > limits.output + 2) return "its content is larger than it may be";
  }
}

}  // namespace

ChildOutcome run_in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
  const pid_t child = ::fork();
  if (child < 0) {
    const int reason = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    throw std::runtime_error(std::string("cannot start a process: ") + std::strerror(reason));
  }
  if (child == 0) run_child(ends[1], work, limits);
  ::close(ends[1]);

  ChildOutcome outcome;
  std::string received;
  outcome.failure = receive(ends[0], limits, received);
  ::close(ends[0]);
  if (!outcome.failure.empty()) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!outcome.failure.empty()) return outcome;
  if (received.size() < 2 || received.back() != end_mark) {
    outcome.failure = "its reader crashed";
    return outcome;
  }
  outcome.finished = received.front() == result_mark;
  (outcome.finished ? outcome.output : outcome.failure) = received.substr(1, received.size() - 2);
  return outcome;
}

}  // namespace clearway
