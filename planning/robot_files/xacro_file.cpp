#include "planning/robot_files/xacro_file.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>

#include "mapping/system/child_process.hpp"

namespace clearway {
namespace {

constexpr int no_such_program = 127;

[[noreturn]] void become_xacro(int output, const std::string& file) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::dup2(output, STDOUT_FILENO);
  ::execlp("xacro", "xacro", file.c_str(), nullptr);
  ::_exit(errno == ENOENT ? no_such_program : 1);
}

/// All that is written, or a little more than `most` bytes.
std::string read_up_to(int descriptor, std::size_t most) {
  std::string text;
  std::array<char, 65536> buffer{};
  while (text.size() <= most + 1) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return text;
}

/// Runs in the child, which its limits hold: the exit status as one byte, and what xacro wrote.
std::string run_xacro(const std::string& file, std::size_t largest) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return "\1";
  const pid_t xacro = ::fork();
  if (xacro < 0) return "\1";
  if (xacro == 0) become_xacro(ends[1], file);
  ::close(ends[1]);
  const std::string text = read_up_to(ends[0], largest);
  if (text.size() > largest) ::kill(xacro, SIGKILL);
  int status = 0;
  while (::waitpid(xacro, &status, 0) < 0 && errno == EINTR) {
  }
  return std::string(1, static_cast<char>(WIFEXITED(status) ? WEXITSTATUS(status) : 1)) + text;
}

}  // namespace

std::string expanded_xacro(const std::filesystem::path& file, std::size_t largest) {
  const std::string name = std::filesystem::absolute(file).string();
  const ChildOutcome run =
      run_in_child([&] { return run_xacro(name, largest); },
                   {.memory = std::size_t{1} << 30U, .output = largest + 1, .seconds = 20});
  if (!run.finished || run.parts.empty() || run.parts.front().empty())
    throw std::invalid_argument(file.string() + ": xacro could not expand it: " + run.failure);
  const std::string& answer = run.parts.front();
  if (answer.front() == no_such_program)
    throw std::invalid_argument(file.string() +
                                ": the program 'xacro' is not installed, expected it or a .urdf that it made "
                                "(xacro FILE > robot.urdf)");
  if (answer.front() != 0)
    throw std::invalid_argument(file.string() +
                                ": xacro could not expand it, expected a xacro file that "
                                "needs no arguments and whose includes are found");
  return answer.substr(1);
}

}  // namespace clearway
