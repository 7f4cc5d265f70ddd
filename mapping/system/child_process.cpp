#include "mapping/system/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string_view>

#include "mapping/system/child_guard.hpp"

namespace clearway {
namespace {

// What a child sends is cut into messages: a mark, the count of bytes that follow, and the bytes.
enum class Mark : char { part = 'P', memory = 'M', failure = 'F', end = 'E' };
struct MessageHead {
  Mark mark = Mark::part;
  std::uint64_t size = 0;
};

constexpr std::size_t most_heads = 1 << 16;  ///< bytes of heads, beyond the parts themselves
constexpr const char* too_large = "its content is larger than it may be";
constexpr const char* too_much_memory = "it asks for more memory than a file of its size can justify";

void send(int pipe, Mark mark, std::string_view text) {
  const MessageHead head{mark, text.size()};
  const bool heard = write_fully(pipe, &head, sizeof(head)) && write_fully(pipe, text.data(), text.size());
  if (!heard) ::_exit(0);  // nobody listens any more
}

[[noreturn]] void run_child(int pipe, pid_t parent, const PartedWork& work, const ChildLimits& limits) {
  const ChildGuard guard{
      .memory = limits.memory, .seconds = static_cast<std::uint64_t>(limits.seconds), .parent = parent};
  int kept = limits.kept;
  if (kept < 0)
    guard_child({&pipe}, guard);
  else
    guard_child({&pipe, &kept}, guard);
  try {
    work([pipe](std::string_view part) { send(pipe, Mark::part, part); });
    send(pipe, Mark::end, "");
  } catch (const std::bad_alloc&) {
    send(pipe, Mark::memory, too_much_memory);
  } catch (const std::exception& error) {
    send(pipe, Mark::failure, error.what());
  } catch (...) {
  }
  ::_exit(0);
}

std::string too_long(const ChildLimits& limits) {
  return "it took longer than " + std::to_string(limits.seconds) + " s";
}

/// Reads until the child closes its end; returns why it stopped earlier, or "".
std::string receive(int pipe, const ChildLimits& limits, std::string& received) {
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::seconds(limits.patience * limits.seconds);
  std::array<char, 65536> buffer{};
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return too_long(limits);
    pollfd waiting{pipe, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
    const ssize_t count = ::read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return "";
    received.append(buffer.data(), static_cast<std::size_t>(count));
    if (received.size() > limits.output + most_heads) return too_large;
  }
}

/// Sorts what arrived into `outcome`, as far as it is whole.
void read_messages(std::string_view received, ChildOutcome& outcome) {
  MessageHead head;
  while (received.size() >= sizeof(head)) {
    std::memcpy(&head, received.data(), sizeof(head));
    received.remove_prefix(sizeof(head));
    if (head.size > received.size()) return;
    const std::string_view text = received.substr(0, head.size);
    received.remove_prefix(head.size);
    if (head.mark == Mark::part) outcome.parts.emplace_back(text);
    if (head.mark == Mark::failure || head.mark == Mark::memory) outcome.failure = text;
    if (head.mark == Mark::memory) outcome.is_out_of_memory = true;
    if (head.mark == Mark::end) outcome.finished = true;
  }
}

}  // namespace

ChildOutcome run_in_child(const PartedWork& work, const ChildLimits& limits) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) {
    const int reason = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    throw std::runtime_error(std::string("cannot start a process: ") + std::strerror(reason));
  }
  if (child == 0) run_child(ends[1], parent, work, limits);
  ::close(ends[1]);

  std::string received;
  const std::string stopped = receive(ends[0], limits, received);
  ::close(ends[0]);
  if (!stopped.empty()) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  ChildOutcome outcome;
  outcome.status = status;
  outcome.is_late = stopped == too_long(limits) || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU);
  read_messages(received, outcome);
  std::size_t size = 0;
  for (const std::string& part : outcome.parts) size += part.size();
  if (!stopped.empty() || size > limits.output) {
    outcome.finished = false;
    outcome.failure = stopped.empty() ? too_large : stopped;
  }
  if (!outcome.finished && outcome.failure.empty())
    outcome.failure = outcome.is_late ? too_long(limits) : "its reader crashed";
  return outcome;
}

ChildOutcome run_in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  return run_in_child([&](const SendPart& send_part) { send_part(work()); }, limits);
}

}  // namespace clearway
