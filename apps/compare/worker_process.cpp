#include "apps/compare/worker_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "mapping/system/child_guard.hpp"

namespace clearway {
namespace {

using Size = std::uint64_t;

bool send_message(int pipe, std::string_view text) {
  const Size size = text.size();
  return write_fully(pipe, &size, sizeof(size)) && write_fully(pipe, text.data(), text.size());
}

/// False at the end of the pipe.
bool read_fully(int pipe, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::read(pipe, to, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    to += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

[[noreturn]] void serve_until_end(int requests, int replies, const WorkerProcess::Serve& serve) {
  const WorkerProcess::Reply reply = [replies](std::string_view text) {
    if (!send_message(replies, text)) ::_exit(0);  // nobody listens any more
  };
  for (Size size = 0; read_fully(requests, reinterpret_cast<char*>(&size), sizeof(size));) {
    std::string request(size, '\0');
    if (!read_fully(requests, request.data(), size)) break;
    serve(request, reply);
  }
  ::_exit(0);
}

/// The end to read from, and the end to write to.
std::pair<FileDescriptor, FileDescriptor> make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

}  // namespace

WorkerProcess::WorkerProcess(const Serve& serve) {
  auto [request_out, request_in] = make_pipe();
  auto [reply_out, reply_in] = make_pipe();
  const FileDescriptor nowhere(::open("/dev/null", O_RDWR | O_CLOEXEC));
  if (!nowhere.is_open())
    throw std::runtime_error(std::string("cannot open /dev/null: ") + std::strerror(errno));
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ < 0) throw std::runtime_error(std::string("cannot start a process: ") + std::strerror(errno));
  if (process_ == 0) {
    int requests = request_out.number(), replies = reply_in.number();
    leave_parent({&requests, &replies}, parent, nowhere.number());
    serve_until_end(requests, replies, serve);
  }
  requests_ = std::move(request_in);
  replies_ = std::move(reply_out);
}

WorkerProcess::~WorkerProcess() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    how_it_ended();
  }
}

void WorkerProcess::ask(std::string_view request) { send_message(requests_.number(), request); }

std::vector<std::string> WorkerProcess::replies() {
  std::array<char, 65536> buffer{};
  const ssize_t count = ::read(replies_.number(), buffer.data(), buffer.size());
  if (count > 0) received_.append(buffer.data(), static_cast<std::size_t>(count));
  if (count == 0 || (count < 0 && errno != EINTR)) has_ended_ = true;
  std::vector<std::string> whole;
  std::size_t at = 0;
  for (Size size = 0; received_.size() - at >= sizeof(size); at += sizeof(size) + size) {
    std::memcpy(&size, received_.data() + at, sizeof(size));
    if (received_.size() - at - sizeof(size) < size) break;
    whole.push_back(received_.substr(at + sizeof(size), size));
  }
  received_.erase(0, at);
  return whole;
}

std::string WorkerProcess::how_it_ended() {
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return end_of_process(status);
}

std::string end_of_process(int status) {
  if (!WIFSIGNALED(status)) return "ended with status " + std::to_string(WEXITSTATUS(status));
  const char* name = sigabbrev_np(WTERMSIG(status));
  return name != nullptr ? "ended by SIG" + std::string(name)
                         : "ended by signal " + std::to_string(WTERMSIG(status));
}

}  // namespace clearway
