#include "tests/mutation/command.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace clearway::mutation {
namespace {

void limit(int resource, std::uint64_t most) {
  const rlimit both{most, most};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// In the child: does not return.
void become(const char* command, const char* folder, const char* log, const Limits& limits) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a run that is broken off leaves nothing running
  const int out = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0600), none = ::open("/dev/null", O_RDONLY);
  if (out < 0 || none < 0 || ::chdir(folder) != 0) ::_exit(126);
  ::dup2(none, 0);
  ::dup2(out, 1);
  ::dup2(out, 2);
  ::setenv("TMPDIR", folder, 1);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<std::uint64_t>(std::ceil(limits.cpu)));
  if (limits.memory > 0) limit(RLIMIT_AS, limits.memory);
  ::execl("/bin/sh", "sh", "-c", command, static_cast<char*>(nullptr));
  ::_exit(127);
}

}  // namespace

Ended run_command(const std::string& command, const std::filesystem::path& folder, const Limits& limits) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path log = folder / "output.log";
  const std::string where = folder.string(), to = log.string();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no process can be started");
  if (child == 0) become(command.c_str(), where.c_str(), to.c_str(), limits);
  Ended ended;
  const auto begin = std::chrono::steady_clock::now();
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    if (!ended.is_late && wall.count() > limits.wall) {
      ended.is_late = true;
      ::kill(-child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::kill(-child, SIGKILL);  // what it left behind
  ended.exit = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  ended.signal = WIFSIGNALED(status) ? WTERMSIG(status) : ended.exit > 128 ? ended.exit - 128 : 0;
  ended.is_late = ended.is_late || ended.signal == SIGXCPU ||
                  (ended.signal == SIGKILL && static_cast<double>(usage.ru_utime.tv_sec) >= limits.cpu - 1.0);
  ended.cpu = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
              1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  std::ifstream in(log, std::ios::binary);
  ended.output.assign(std::istreambuf_iterator<char>(in), {});
  return ended;
}

}  // namespace clearway::mutation
