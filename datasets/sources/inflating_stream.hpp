#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

struct z_stream_s;

namespace clearway {

/// The compressed layer itself is damaged (checksum, cut member, bytes behind the end).
struct DamagedStream : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file, gz (several members allowed) or plain, read front to back. Unlike MRPT's own gz stream it insists
/// on every member's checksum and size, so a log whose last bytes are cut is not taken for whole.
/// The capitalised functions are what MRPT's archive asks of a stream.
class InflatingStream {
 public:
  /// Reads from `descriptor`, which stays open and belongs to the caller.
  explicit InflatingStream(int descriptor);
  ~InflatingStream();
  InflatingStream(const InflatingStream&) = delete;
  InflatingStream& operator=(const InflatingStream&) = delete;

  /// True when nothing is left. @throws DamagedStream when what ends here does not end as it should.
  bool at_end();
  /// Bytes of the file used up so far.
  uint64_t file_offset() const;
  bool compressed() const { return compressed_; }
  /// What was thrown as DamagedStream, for callers behind MRPT, which wraps exceptions; empty when nothing
  /// was.
  const std::string& damage() const { return damage_; }

  /// Fills `target` as far as the stream reaches and returns how far that was. @throws DamagedStream
  size_t Read(void* target, size_t size);
  size_t Write(const void*, size_t) { throw std::logic_error("a recording is read only"); }
  std::string getStreamDescription() const { return "recording"; }

 private:
  bool fill_raw();
  void inflate_more();
  [[noreturn]] void fail(const std::string& reason);

  int descriptor_;
  bool compressed_ = false;
  bool member_open_ = false;
  bool finished_ = false;
  std::string damage_;
  uint64_t bytes_read_ = 0;
  std::array<unsigned char, 1 << 16> raw_, plain_;
  size_t raw_begin_ = 0, raw_end_ = 0, plain_begin_ = 0, plain_end_ = 0;
  std::unique_ptr<z_stream_s> inflater_;
};

}  // namespace clearway
