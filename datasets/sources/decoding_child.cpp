#include "datasets/sources/decoding_child.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "datasets/sources/frame_bytes.hpp"
#include "datasets/sources/inflating_stream.hpp"
#include "datasets/sources/rawlog_decoder.hpp"
#include "datasets/sources/sealed_records.hpp"
#include "mapping/system/child_guard.hpp"

namespace clearway {
namespace {

constexpr uint64_t megabyte = 1 << 20;

struct MessageHead {
  uint64_t kind, offset, size;
};

/// The child's side of the pipe; leaves the process when nobody listens any more.
class Sender {
 public:
  explicit Sender(int descriptor) : descriptor_(descriptor) {}
  void send(ChildMessage::Kind kind, uint64_t offset, std::string_view text) const {
    const MessageHead head{kind, offset, text.size()};
    const bool heard =
        write_fully(descriptor_, &head, sizeof head) && write_fully(descriptor_, text.data(), text.size());
    if (!heard) _exit(3);
  }

 private:
  int descriptor_;
};

/// MRPT's messages run over many lines and name source files; the first line that says something is enough.
std::string first_line(const std::string& message) {
  const auto told = message.find("Message:");  // below MRPT's banner
  const auto begin = message.find_first_not_of(" \t\r\n", told == std::string::npos ? 0 : told + 8);
  if (begin == std::string::npos) return "no reason given";
  std::string line = message.substr(begin, message.find_first_of("\r\n", begin) - begin);
  const auto prefix = line.rfind("] ");  // "[file.cpp:123, function] what happened"
  return prefix == std::string::npos || prefix + 2 >= line.size() ? line : line.substr(prefix + 2);
}

constexpr const char* no_memory = "the object asks for more memory than the file can justify";

std::string undecoded(const std::exception& error) {
  return "the object cannot be decoded (" + first_line(error.what()) + ")";
}

/// A log whose records have no checksums of their own: damage ends it.
void decode_stream(const Sender& sender, int file) {
  InflatingStream stream(file);
  RawlogDecoder decoder([&stream](void* target, size_t size) { return stream.Read(target, size); });
  const auto send = [&](ChildMessage::Kind kind, std::string_view text) {
    sender.send(kind, stream.file_offset(), text);
  };
  try {
    while (!stream.at_end()) {
      decoder.decode_object([&](DecodedFrame&& frame) { send(ChildMessage::frame, frame_to_bytes(frame)); },
                            [&](const std::string& why) { send(ChildMessage::skipped, why); });
      send(ChildMessage::object, "");
    }
    send(ChildMessage::end, "");
  } catch (const std::bad_alloc&) {
    send(ChildMessage::damage, no_memory);
  } catch (const std::exception& error) {
    send(ChildMessage::damage, !stream.damage().empty() ? stream.damage() : undecoded(error));
  }
}

/// A log of ours: MRPT sees only records that pass their checksums.
void decode_sealed(const Sender& sender, int file, uint64_t file_size) {
  SealedRecords records(file, file_size);
  std::string_view left;
  RawlogDecoder decoder([&left](void* target, size_t size) {
    const size_t part = std::min(size, left.size());
    std::memcpy(target, left.data(), part);
    left.remove_prefix(part);
    return part;
  });
  const auto send = [&](ChildMessage::Kind kind, std::string_view text) {
    sender.send(kind, records.offset(), text);
  };
  try {
    while (const auto record = records.next()) {
      if (!record->content) {
        send(ChildMessage::lost, record->loss);
        continue;
      }
      left = *record->content;
      decoder.decode_object([&](DecodedFrame&& frame) { send(ChildMessage::frame, frame_to_bytes(frame)); },
                            [&](const std::string& why) { send(ChildMessage::skipped, why); });
      send(ChildMessage::object, "");
    }
    send(ChildMessage::end, "");
  } catch (const std::bad_alloc&) {
    send(ChildMessage::damage, no_memory);
  } catch (const std::exception& error) {
    send(ChildMessage::damage, undecoded(error));
  }
}

void decode(const Sender& sender, int file, uint64_t file_size) {
  if (SealedRecords::are_in(file, file_size)) return decode_sealed(sender, file, file_size);
  decode_stream(sender, file);
}

}  // namespace

DecodingChild::DecodingChild(int descriptor, uint64_t file_size)
    : largest_message_(128 * megabyte + 20 * file_size) {
  register_rawlog_classes();  // before the fork: other threads may hold MRPT's locks during it
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  child_ = fork();
  if (child_ == 0) {
    // It may outlive the thread that opened the recording, which is read on elsewhere.
    guard_child({&ends[1], &descriptor},
                {.memory = 128 * megabyte + 20 * file_size, .seconds = 60 + 10 * (file_size / megabyte)});
    try {
      decode(Sender(ends[1]), descriptor, file_size);
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

bool DecodingChild::read_fully(void* target, size_t size) {
  char* next = static_cast<char*>(target);
  while (size > 0) {
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
  if (!read_fully(&head, sizeof head)) return obituary();
  ChildMessage message;
  if (head.kind > ChildMessage::end || head.size > largest_message_) return obituary();
  message.kind = static_cast<ChildMessage::Kind>(head.kind);
  message.offset = head.offset;
  // Grown as it arrives: a head torn by a dying child must not make us ask for all of it.
  while (message.text.size() < head.size) {
    const size_t begin = message.text.size();
    message.text.resize(begin + std::min<uint64_t>(head.size - begin, 16 * megabyte));
    if (!read_fully(message.text.data() + begin, message.text.size() - begin)) return obituary();
  }
  return message;
}

ChildMessage DecodingChild::obituary() {
  if (child_ < 0) return {ChildMessage::damage, 0, "the decoder is gone"};
  kill(child_, SIGKILL);  // a babbling child; one that died keeps its own status
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU) return {ChildMessage::damage, 0, "decoding the object did not come to an end"};
  return {ChildMessage::damage, 0,
          signal ? "the object crashed the decoder (signal " + std::to_string(signal) + ")"
                 : "the object ended the decoder"};
}

}  // namespace clearway
