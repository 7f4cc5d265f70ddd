#include "planning/robot_files/xacro_file.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <vector>

#include "mapping/system/child_process.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr int no_such_program = 127;

/// @param words of its command line, the program first
[[noreturn]] void become_xacro(int output, std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::dup2(output, STDOUT_FILENO);
  ::execvp("xacro", arguments.data());
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
std::string run_xacro(std::vector<std::string> words, std::size_t largest) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return "\1";
  const pid_t xacro = ::fork();
  if (xacro < 0) return "\1";
  if (xacro == 0) become_xacro(ends[1], words);
  ::close(ends[1]);
  const std::string text = read_up_to(ends[0], largest);
  if (text.size() > largest) ::kill(xacro, SIGKILL);
  int status = 0;
  while (::waitpid(xacro, &status, 0) < 0 && errno == EINTR) {
  }
  return std::string(1, static_cast<char>(WIFEXITED(status) ? WEXITSTATUS(status) : 1)) + text;
}

std::string answer_of_xacro(const std::vector<std::string>& words, const std::filesystem::path& file,
                            std::size_t largest) {
  const ChildOutcome run =
      run_in_child([&] { return run_xacro(words, largest); },
                   {.memory = std::size_t{1} << 30U, .output = largest + 1, .seconds = 20});
  if (!run.finished || run.parts.empty() || run.parts.front().empty())
    throw std::invalid_argument(file.string() + ": xacro could not expand it: " + run.failure);
  const std::string& answer = run.parts.front();
  if (answer.front() == no_such_program)
    throw std::invalid_argument(file.string() +
                                ": the program 'xacro' is not installed, expected it or a .urdf that it made "
                                "(xacro FILE NAME:=VALUE > robot.urdf)");
  if (answer.front() != 0)
    throw std::invalid_argument(file.string() +
                                ": xacro could not expand it, expected a xacro file whose includes are "
                                "found and whose arguments --xacro NAME:=VALUE or the settings' xacro: "
                                "give");
  return answer.substr(1);
}

}  // namespace

bool is_xacro_name(const std::string& name) {
  const auto is_part = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), is_part);
}

std::string expanded_xacro(const std::filesystem::path& file, std::size_t largest,
                           const XacroArguments& arguments) {
  std::vector<std::string> words{"xacro", whole_input_path(file).string()};
  for (const auto& [name, value] : arguments) {
    if (!is_xacro_name(name))
      throw std::invalid_argument(file.string() + ": xacro argument " + quote(name) +
                                  ": expected a name of letters, digits and underscores");
    words.push_back(name + ":=" + value);
  }
  std::string question;
  for (const std::string& word : words) question += (question.empty() ? "" : " ") + word;
  return kept_answer(question, [&] { return answer_of_xacro(words, file, largest); });
}

}  // namespace clearway
