#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "datasets/ros/wire_reader.hpp"

// What an MCAP file is read by: its records, and their fields.

namespace clearway::mcap {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t record_head = 9;  ///< an opcode and a size of 8 bytes

/// Fields of a record: numbers little-endian and packed, as ROS 1 has them.
class Fields {
 public:
  explicit Fields(Bytes bytes) : in_(bytes, RosWire::ros1), bytes_(bytes) {}
  template <class Number>
  Number number() {
    at_ += sizeof(Number);
    return in_.number<Number>();
  }
  std::string text() {
    std::string result = in_.text();
    at_ += 4 + result.size();
    return result;
  }
  Bytes rest() const { return bytes_.subspan(at_); }

 private:
  WireReader in_;
  Bytes bytes_;
  std::size_t at_ = 0;
};

struct Record {
  std::uint8_t opcode = 0;
  Bytes content;
};

/// The records of a chunk.
class Records {
 public:
  explicit Records(Bytes bytes) : bytes_(bytes) {}
  bool is_at_end() const { return at_ == bytes_.size(); }
  /// Nothing: what is left is not a whole record.
  std::optional<Record> next() {
    if (bytes_.size() - at_ < record_head) return std::nullopt;
    std::uint64_t size = 0;
    std::memcpy(&size, &bytes_[at_ + 1], sizeof size);
    if (size > bytes_.size() - at_ - record_head) return std::nullopt;
    const Record record{bytes_[at_], bytes_.subspan(at_ + record_head, size)};
    at_ += record_head + size;
    return record;
  }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

/// The file, a part at a time.
class File {
 public:
  File(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}
  std::uint64_t size() const { return size_; }

  /// Valid until the next call. @throws std::runtime_error when the file does not have them.
  Bytes read(std::uint64_t at, std::uint64_t count);

 private:
  int descriptor_;
  std::uint64_t size_, begin_ = 0;
  std::vector<std::uint8_t> part_;
};

}  // namespace clearway::mcap
