#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

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

/// The child process that decodes a rawlog: its memory is limited to 128 MB + 20 times the file (beyond what
/// this process already uses), its processor time to a minute and 10 s per MB, it prints nothing and touches
/// nothing. It dies when this object does.
class DecodingChild {
 public:
  /// Decodes what `descriptor` (opened, at the start of the log) holds. @throws std::runtime_error when the
  /// system gives no process or pipe.
  DecodingChild(int descriptor, uint64_t file_size);
  ~DecodingChild();
  DecodingChild(const DecodingChild&) = delete;
  DecodingChild& operator=(const DecodingChild&) = delete;

  /// Waits for the next message; a child that died or babbles is a `damage` message saying so.
  ChildMessage receive();

 private:
  bool read_fully(void* target, size_t size);
  ChildMessage obituary();

  pid_t child_ = -1;
  int pipe_ = -1;
  uint64_t largest_message_;
};

}  // namespace clearway
