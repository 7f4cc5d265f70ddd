#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace clearway {

/// Puts the fields of a ROS 2 message into bytes: CDR (XCDR1), little-endian, numbers aligned.
class WireWriter {
 public:
  template <class Number>
  void number(Number value) {
    align(sizeof(Number));
    append(&value, sizeof value);
  }
  void text(std::string_view text);
  void bytes(std::span<const std::uint8_t> bytes);
  /// Of the elements that follow.
  void length(std::size_t count) { number(static_cast<std::uint32_t>(count)); }
  template <class Numbers>
  void numbers(const Numbers& list) {
    length(static_cast<std::size_t>(list.size()));
    for (const auto value : list) number(value);
  }

  const std::string& message() const { return message_; }

 private:
  void align(std::size_t size);
  void append(const void* from, std::size_t size);

  std::string message_ = std::string("\0\1\0\0", 4);
};

}  // namespace clearway
