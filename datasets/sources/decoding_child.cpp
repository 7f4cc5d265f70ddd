#include "datasets/sources/decoding_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include "mapping/system/child_guard.hpp"

namespace clearway {
namespace {

constexpr uint64_t megabyte = 1 << 20;

struct MessageHead {
  uint64_t kind, offset, size;
};

/// What a child has used, nanoseconds; -1: it is gone.
int64_t processor_time(pid_t child) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &time) != 0) return -1;
  return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

void ChildReport::send(ChildMessage::Kind kind, uint64_t offset, std::string_view text) const {
  const MessageHead head{kind, offset, text.size()};
  const bool heard = write_fully(pipe_, &head, sizeof head) && write_fully(pipe_, text.data(), text.size());
  if (!heard) _exit(3);
}

DecodingLimits DecodingLimits::of_file(uint64_t bytes) {
  return {.memory = 128 * megabyte + 20 * bytes, .seconds = 60 + 10 * (bytes / megabyte)};
}

DecodingChild::DecodingChild(const DecodingLimits& limits, int descriptor, const Work& work)
    : limits_(limits) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  child_ = fork();
  if (child_ == 0) {
    // It may outlive the thread that opened the recording, which is read on elsewhere.
    const ChildGuard guard{.memory = limits.memory, .seconds = limits.seconds};
    if (descriptor >= 0) {
      guard_child({&ends[1], &descriptor}, guard);
    } else {
      guard_child({&ends[1]}, guard);
    }
    try {
      work(ChildReport(ends[1]), descriptor);
    } catch (...) {
      _exit(2);
    }
    _exit(0);
  }
  const int error = errno;
  close(ends[1]);
  pipe_ = ends[0];
  if (child_ < 0) {
    close(pipe_);
    throw std::runtime_error(std::string("no process to decode the recording: ") + std::strerror(error));
  }
}

DecodingChild::~DecodingChild() {
  close(pipe_);
  if (child_ < 0) return;
  kill(child_, SIGKILL);
  while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// False when the child has done nothing for too long. Its processor time limits what it computes; but a fork
/// of a program with several threads may wait for a lock that none of them is there to release.
bool DecodingChild::wait_for_bytes() {
  int64_t used = -1;
  for (int idle = 0; idle < limits_.patience; ++idle) {
    pollfd pipe{pipe_, POLLIN, 0};
    const int ready = poll(&pipe, 1, 1000);
    if (ready > 0 || (ready < 0 && errno != EINTR)) return true;
    const int64_t now = processor_time(child_);
    if (now != used) idle = -1;
    used = now;
  }
  is_stuck_ = true;
  return false;
}

bool DecodingChild::read_fully(void* target, size_t size) {
  char* next = static_cast<char*>(target);
  while (size > 0) {
    if (!wait_for_bytes()) return false;
    const ssize_t got = ::read(pipe_, next, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    next += got;
    size -= static_cast<size_t>(got);
  }
  return true;
}

ChildMessage DecodingChild::receive() {
  MessageHead head{};
  if (!read_fully(&head, sizeof head)) return exit_message();
  ChildMessage message;
  if (head.kind > ChildMessage::end || head.size > limits_.memory) return exit_message();
  message.kind = static_cast<ChildMessage::Kind>(head.kind);
  message.offset = head.offset;
  // Grown as it arrives: a head torn by a dying child must not make us ask for all of it.
  while (message.text.size() < head.size) {
    const size_t begin = message.text.size();
    message.text.resize(begin + std::min<uint64_t>(head.size - begin, 16 * megabyte));
    if (!read_fully(message.text.data() + begin, message.text.size() - begin)) return exit_message();
  }
  return message;
}

ChildMessage DecodingChild::exit_message() {
  if (child_ < 0) return {ChildMessage::damage, 0, "the decoder is gone"};
  kill(child_, SIGKILL);  // a babbling child; one that died keeps its own status
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (is_stuck_ || signal == SIGXCPU)
    return {ChildMessage::damage, 0, "decoding the object did not come to an end"};
  return {ChildMessage::damage, 0,
          signal ? "the object crashed the decoder (signal " + std::to_string(signal) + ")"
                 : "the object ended the decoder"};
}

}  // namespace clearway
