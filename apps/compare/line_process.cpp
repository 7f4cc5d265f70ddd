#include "apps/compare/line_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "apps/compare/worker_process.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t longest_line = std::size_t{1} << 26U, most_last_words = 2000;
constexpr int pause_ms = 10;

[[noreturn]] void fail_to_start() {
  throw std::runtime_error(std::string("cannot start a process: ") + std::strerror(errno));
}

/// Whether the shell need not stay between: one program and its arguments, nothing that the shell itself
/// does.
bool is_plain(const std::string& command) {
  static const std::set<std::string> of_shell = {".",     "cd",   "source", "export", "set", "ulimit",
                                                 "umask", "eval", "exec",   "if",     "for", "while",
                                                 "until", "case", "time",   "!",      "{"};
  char quote = 0;
  for (const char letter : command) {
    if (quote != 0) {
      if (letter == quote) quote = 0;
    } else if (letter == '\'' || letter == '"') {
      quote = letter;
    } else if (std::string_view(";&|()<>`\n").find(letter) != std::string_view::npos) {
      return false;
    }
  }
  std::istringstream words(command);
  std::string first;
  words >> first;
  return first.find('=') == std::string::npos && !of_shell.contains(first);
}

/// Seconds of CPU of a process; with those of the ones that it started and that run.
double cpu_of_family(pid_t process, bool with_children) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return 0.0;
  double sum = static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  if (!with_children) return sum;
  const std::string number = std::to_string(process);
  std::ifstream children("/proc/" + number + "/task/" + number + "/children");
  for (pid_t child = 0; children >> child;) sum += cpu_of_family(child, true);
  return sum;
}

/// In the child: the program takes its place. Only calls that are safe after a fork.
[[noreturn]] void become(const char* command, int talk, int complaints, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  ::signal(SIGPIPE, SIG_DFL);
  sigset_t none;  // ours waits for signals in a thread, which has them blocked
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::signal(SIGXFSZ, SIG_IGN);  // in an isolated run it may write no files: it is told so by write()
  ::dup2(talk, 0);
  ::dup2(talk, 1);
  ::dup2(complaints, 2);
  ::execl("/bin/sh", "sh", "-c", command, static_cast<char*>(nullptr));
  ::_exit(127);
}

}  // namespace

LineProcess::LineProcess(const std::string& command) {
  std::array<int, 2> talk{}, complaints{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, talk.data()) != 0) fail_to_start();
  talk_ = FileDescriptor(talk[0]);
  const FileDescriptor its_talk(talk[1]);
  if (::pipe2(complaints.data(), O_CLOEXEC) != 0) fail_to_start();
  complaints_ = FileDescriptor(complaints[0]);
  const FileDescriptor its_complaints(complaints[1]);
  for (const FileDescriptor* own : {&std::as_const(talk_), &std::as_const(complaints_)})
    ::fcntl(own->number(), F_SETFL, O_NONBLOCK);
  is_under_shell_ = !is_plain(command);
  const std::string line = is_under_shell_ ? command : "exec " + command;
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ < 0) fail_to_start();
  if (process_ == 0) become(line.c_str(), its_talk.number(), its_complaints.number(), parent);
}

LineProcess::~LineProcess() {
  if (process_ <= 0) return;
  ::kill(-process_, SIGKILL);
  ::kill(process_, SIGKILL);  // where it has not yet a group of its own
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<std::string> LineProcess::ask(std::string_view line, const std::function<bool()>& is_late) {
  const std::string whole = std::string(line) + '\n';
  std::string_view rest = whole;
  for (;;) {
    if (rest.empty())
      if (std::optional<std::string> answer = take_line()) return answer;
    if (is_late()) return std::nullopt;
    std::array<pollfd, 2> waiting{{{talk_.number(), POLLIN, 0}, {complaints_.number(), POLLIN, 0}}};
    if (!rest.empty()) waiting[0].events |= POLLOUT;
    ::poll(waiting.data(), complaints_.is_open() ? 2 : 1, pause_ms);
    if ((waiting[0].revents & POLLOUT) != 0) send_some(rest);
    if (complaints_.is_open() && waiting[1].revents != 0) hear_complaints();
    if ((waiting[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0) receive_some();
  }
}

std::optional<std::string> LineProcess::unasked() {
  pollfd waiting{talk_.number(), POLLIN, 0};
  if (::poll(&waiting, 1, 0) > 0 && (waiting.revents & POLLIN) != 0) receive_some();
  return take_line();
}

double LineProcess::cpu_seconds() const { return cpu_of_family(process_, is_under_shell_); }

void LineProcess::send_some(std::string_view& rest) {
  const ssize_t count = ::send(talk_.number(), rest.data(), rest.size(), MSG_NOSIGNAL);
  if (count > 0) rest.remove_prefix(static_cast<std::size_t>(count));
  if (count < 0 && errno != EAGAIN && errno != EINTR) fail("does not read what it is sent");
}

void LineProcess::receive_some() {
  std::array<char, 65536> buffer{};
  const ssize_t count = ::recv(talk_.number(), buffer.data(), buffer.size(), 0);
  if (count > 0) received_.append(buffer.data(), static_cast<std::size_t>(count));
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) fail("ended without an answer");
  if (received_.size() > longest_line) fail("answered with a line longer than 64 MB");
}

std::optional<std::string> LineProcess::take_line() {
  const std::size_t end = received_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = received_.substr(0, end);
  received_.erase(0, end + 1);
  return line;
}

void LineProcess::hear_complaints() {
  std::array<char, 4096> buffer{};
  const ssize_t count = ::read(complaints_.number(), buffer.data(), buffer.size());
  if (count > 0) last_words_.append(buffer.data(), static_cast<std::size_t>(count));
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) complaints_ = FileDescriptor();
  if (last_words_.size() > most_last_words) last_words_.erase(0, last_words_.size() - most_last_words);
}

namespace {

/// What a program that may write no file says of that: system's words, or those of Python and of Node.
bool tells_of_forbidden_file(const std::string& complaints) {
  rlimit files{};
  if (::getrlimit(RLIMIT_FSIZE, &files) != 0 || files.rlim_cur != 0) return false;
  for (const char* words : {"File too large", "EFBIG", "Errno 27"})
    if (complaints.find(words) != std::string::npos) return true;
  return false;
}

/// The last line that is not empty.
std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos) return {};
  const std::string words = text.substr(0, end + 1);
  return words.substr(words.find_last_of('\n') + 1);  // all of it where there is none
}

/// Whether memory is limited and the program ended with an error of it: by the words of Python, C++, Java,
/// Rust and the system in its last line, or because it took most of what it may.
bool ran_out_of_memory(const std::string& complaints, int status, const rusage& used) {
  rlimit memory{};
  if (::getrlimit(RLIMIT_AS, &memory) != 0 || memory.rlim_cur == RLIM_INFINITY) return false;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return false;
  const std::string last = last_line(complaints);
  for (const char* words : {"MemoryError", "bad_alloc", "Cannot allocate memory", "OutOfMemory",
                            "out of memory", "Out of memory", "memory allocation of", "Unable to allocate"})
    if (last.find(words) != std::string::npos) return true;
  return 1024.0 * static_cast<double>(used.ru_maxrss) > 0.9 * static_cast<double>(memory.rlim_cur);
}

}  // namespace

/// With the last line that it wrote to its standard error, and how it ended, if it did within a moment.
void LineProcess::fail(const std::string& what) {
  int status = 0;
  pid_t ended = 0;
  rusage used{};
  for (int i = 0; i < 50 && ended == 0; ++i) {
    ended = ::wait4(process_, &status, WNOHANG, &used);
    if (ended == 0) ::poll(nullptr, 0, pause_ms);
  }
  while (complaints_.is_open()) {
    pollfd waiting{complaints_.number(), POLLIN, 0};
    if (::poll(&waiting, 1, 0) <= 0) break;
    hear_complaints();
  }
  std::string sentence = "the planner's program " + (ended > 0 ? end_of_process(status) : what);
  if (ended > 0) process_ = -1;
  if (!received_.empty() && received_.size() <= longest_line)
    sentence += "; its last line has no newline, expected one after each answer";
  if (const std::string last = last_line(last_words_); !last.empty())
    sentence += "; its last line of errors: " + quote(last);
  if (tells_of_forbidden_file(last_words_))
    sentence += "; it tried to write into a file, which an isolated run may not: --isolate no lets it";
  if (ended > 0 && ran_out_of_memory(last_words_, status, used)) throw ProgramOutOfMemory(sentence);
  throw std::runtime_error(sentence);
}

}  // namespace clearway
