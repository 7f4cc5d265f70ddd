#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace clearway {

/// One message of the decoding child, in the order things happen in the file.
struct ChildMessage {
  enum Kind : uint8_t {
    frame,    ///< bytes of a frame (frame_bytes.hpp)
    object,   ///< an object has been read whole; `offset` says how much of the file that took
    lost,     ///< records of a sealed log that are not used; the text says which; reading goes on
    skipped,  ///< an observation was left out; the text says why, or is empty
    damage,   ///< reading ends here for the reason in the text
    end       ///< the log ended as it should
  };
  Kind kind = end;
  uint64_t offset = 0;
  std::string text;
};

/// The child's side of the pipe; leaves the process when nobody listens any more.
class ChildReport {
 public:
  explicit ChildReport(int pipe) : pipe_(pipe) {}
  void send(ChildMessage::Kind kind, uint64_t offset, std::string_view text) const;

 private:
  int pipe_;
};

/// What a decoding child may take.
struct DecodingLimits {
  uint64_t memory = 0;   ///< bytes beyond what this process already uses; of a message, too
  uint64_t seconds = 0;  ///< of processor time
  int patience = 30;  ///< seconds for which it may neither compute nor send anything while it is waited for

  /// 128 MB and 20 times the bytes; a minute and 10 s per MB.
  static DecodingLimits of_file(uint64_t bytes);
};

/// A child process that decodes recordings: its memory and time are limited, it prints nothing and changes
/// nothing. It dies when this object does.
class DecodingChild {
 public:
  /// What the child does: the last message that it sends is `damage` or `end`.
  using Work = std::function<void(const ChildReport&, int descriptor)>;

  /// @param descriptor the open file that it reads, the only one it keeps; -1: none
  /// @throws std::runtime_error when the system gives no process or pipe.
  DecodingChild(const DecodingLimits& limits, int descriptor, const Work& work);
  ~DecodingChild();
  DecodingChild(const DecodingChild&) = delete;
  DecodingChild& operator=(const DecodingChild&) = delete;

  /// Waits for the next message; a child that died, babbles or waits for ever is a `damage` message saying
  /// so.
  ChildMessage receive();

 private:
  bool wait_for_bytes();
  bool read_fully(void* target, size_t size);
  ChildMessage exit_message();

  pid_t child_ = -1;
  int pipe_ = -1;
  DecodingLimits limits_;
  bool is_stuck_ = false;
};

}  // namespace clearway
